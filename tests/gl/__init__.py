"""OpenGL without a window, as a partner to compare with."""
