"""Case files: line, pantographs, analysis section and limits, each number with its source."""
