"""Images: display encoding, files, and how far noise lets a score be trusted."""
