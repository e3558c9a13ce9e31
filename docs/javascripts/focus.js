/* What scrolls sideways can be reached, and moved with the arrow keys, without a mouse. The theme does so only where a mouse hovers. */
const BOXES = ".md-typeset pre > code, .highlight-ipynb, .md-typeset__scrollwrap, .jp-OutputArea-output";
const known = new WeakSet();

function reach(box) {
  if (known.has(box)) return;
  known.add(box);
  const mark = () => {
    if (box.tabIndex < 0 && box.scrollWidth > box.clientWidth) box.tabIndex = 0;
  };
  new MutationObserver(mark).observe(box, { attributeFilter: ["tabindex"] });
  const sizes = new ResizeObserver(mark);
  for (const each of [box, ...box.children]) sizes.observe(each);
}

function all() {
  document.querySelectorAll(BOXES).forEach(reach);
  /* The theme makes a landmark of the buttons of each piece of code. */
  document.querySelectorAll("nav.md-code__nav:not([role])").forEach((buttons) => buttons.setAttribute("role", "presentation"));
}
all();
/* The theme wraps tables, and adds buttons, after this script has begun. */
new MutationObserver(all).observe(document.querySelector("main"), { childList: true, subtree: true });
