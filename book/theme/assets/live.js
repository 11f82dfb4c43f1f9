/** Live cells: the studio or its widget in place of a picture, loaded from this website. */
const studio = new URL("../studio/", import.meta.url);
let parts;

/** Loads the widget and the core once. */
function load() {
  parts ??= Promise.all([
    import(new URL("widget.mjs", studio)),
    fetch(new URL("midair.wasm", studio)).then((answer) => answer.arrayBuffer()),
  ]);
  return parts;
}

/** Shows the scene of a cell, or a page in a frame; if that fails, the picture stays. */
async function show(cell) {
  if (cell.dataset.shown) return;
  cell.dataset.shown = "1";
  if (cell.dataset.page) {
    const frame = Object.assign(document.createElement("iframe"), { src: cell.dataset.page, title: "Studio" });
    frame.addEventListener("load", () => cell.classList.add("live-on"));
    cell.append(frame);
    return;
  }
  const place = document.createElement("div");
  place.className = "live-view";
  try {
    const [[{ default: widget }, wasm], answer] = await Promise.all([load(), fetch(cell.dataset.scene)]);
    const values = { wasm: new DataView(wasm), scene: await answer.text() };
    cell.append(place);
    await widget.render({
      el: place,
      model: { get: (name) => values[name], set() {}, save_changes() {}, on() {}, off() {} },
    });
    cell.classList.add("live-on");
  } catch (error) {
    place.remove();
    console.info(`no live cell: ${error.message}`);
  }
}

const seen = new IntersectionObserver((entries) => {
  for (const { isIntersecting, target } of entries) {
    if (!isIntersecting) continue;
    seen.unobserve(target);
    show(target);
  }
});

for (const cell of document.querySelectorAll(".live")) {
  const button = cell.querySelector("button");
  if (button) button.addEventListener("click", () => show(cell));
  else if (!navigator.connection?.saveData) seen.observe(cell);
}
