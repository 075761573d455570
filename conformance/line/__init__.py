"""Line: its file, its elements, their model, tables and drawing."""
