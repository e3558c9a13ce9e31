/* What scrolls sideways can be reached, and moved with the arrow keys, without a mouse. The theme does so only where a mouse hovers. */
for (const box of document.querySelectorAll(".md-typeset pre > code, .highlight-ipynb, .md-typeset__scrollwrap, .jp-OutputArea-output")) {
  const mark = () => {
    if (box.tabIndex < 0 && box.scrollWidth > box.clientWidth) box.tabIndex = 0;
  };
  new MutationObserver(mark).observe(box, { attributeFilter: ["tabindex"] });
  new ResizeObserver(mark).observe(box);
}
