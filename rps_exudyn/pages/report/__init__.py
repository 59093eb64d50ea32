"""One self-contained HTML page about studies and single results.

study_page.py, study_sections.py, result_page.py and fit_page.py fill the page; pictures.py turns charts into
SVG; html.py with page.html and page.css makes the HTML; report.py writes the file.
"""
