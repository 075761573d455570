"""FMUs of linear pantographs, and the accuracy of their coupling."""
