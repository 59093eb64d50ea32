"""One self-contained HTML page about studies and single results.

blocks.py defines the parts of a page; study_page.py and result_page.py fill it, common.py serves both;
pictures.py turns charts into SVG; html.py with page.html and page.css makes the HTML; report.py writes
the file.
"""
