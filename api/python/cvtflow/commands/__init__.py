"""Commands of the program, one module each; __main__.py lists them."""
