/** Makes tables that scroll reachable by the keyboard. */
document$.subscribe(() => {
  document.querySelectorAll(".md-typeset__scrollwrap").forEach((table, index) => {
    table.tabIndex = 0;
    table.setAttribute("role", "region");
    table.setAttribute("aria-label", `Table ${index + 1}`);
  });
});
