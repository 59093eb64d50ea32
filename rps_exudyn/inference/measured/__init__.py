"""Files of measured curves as test benches write them: text, layout, numbers, columns and their units."""
