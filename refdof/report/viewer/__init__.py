"""Scripts and styles of the report's page, each a file as it goes into the page."""
