"""Line files: elements, layout, tables, statics and drawing."""
