"""Explorer: a page on this machine whose sliders run the simulator."""
