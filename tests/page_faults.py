"""What is wrong with a page as a browser shows it: text over text, text beside the window.

    page_faults(page)  # ["'teeth' lies over 'bush'", "'definition' is beyond the window"]

Tables and code that scroll by themselves may be wider than the window.
"""

from itertools import combinations

from playwright import sync_api

BESIDE, OVER = 2.0, 0.35  # overlap across [pixels], and down over the height of the lower text
_TEXTS = """() => {
  const found = [], walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  const overflows = (item) => ["auto", "scroll"].includes(getComputedStyle(item).overflowX);
  const scrolls = (item) => item && (overflows(item) || scrolls(item.parentElement));
  const seen = { contentVisibilityAuto: true, visibilityProperty: true };
  for (let node; (node = walker.nextNode());) {
    const parent = node.parentElement, text = node.textContent.trim();
    if (!text || parent.closest("script, style") || !parent.checkVisibility(seen)) continue;
    if (scrolls(parent)) continue;
    const range = document.createRange();
    range.selectNodeContents(node);
    for (const { left, top, right, bottom } of range.getClientRects()) {
      if (right > left && bottom > top) found.push([text.slice(0, 40), left, top, right, bottom]);
    }
  }
  return [document.documentElement.clientWidth, found];
}"""


def page_faults(page: sync_api.Page) -> list[str]:
    """Return one sentence for each fault."""
    wide, texts = page.evaluate(_TEXTS)
    found = [f"'{text}' is beyond the window" for text, left, _, right, _ in texts
             if left < -1 or right > wide + 1]  # fmt: skip
    for (one, *its), (other, *others) in combinations(texts, 2):
        across = min(its[2], others[2]) - max(its[0], others[0])
        down = min(its[3], others[3]) - max(its[1], others[1])
        if across > BESIDE and down > OVER * min(its[3] - its[1], others[3] - others[1]):
            found.append(f"'{one}' lies over '{other}'")
    return list(dict.fromkeys(found))
