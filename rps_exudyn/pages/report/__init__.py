"""One self-contained HTML page about studies and single results.

study_page.py, result_page.py and fit_page.py make sheets; pictures.py turns charts into SVG; html.py with
page.html and page.css makes the HTML; write_report.py writes the file.
"""
