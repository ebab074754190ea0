"""Report: a comparison as tables, pictures, an overview figure and an offline page to flip images."""

from refdof.report.rows import rows_as_json
from refdof.report.table import files_line, markdown_table, terminal_table
from refdof.report.write import write_comparison, write_comparisons

__all__ = ["files_line", "markdown_table", "rows_as_json", "terminal_table", "write_comparison", "write_comparisons"]
