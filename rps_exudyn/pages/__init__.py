"""What people look at: charts, reports, animations, and the page with sliders."""
