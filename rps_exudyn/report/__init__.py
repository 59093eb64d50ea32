"""One self-contained HTML page about a study or about single results.

blocks.py: what a page is made of; study_page.py and result_page.py fill it, common.py what both need;
pictures.py turns charts into SVG; html.py with page.html and page.css sets the page; report.py makes the
file from paths.
"""
