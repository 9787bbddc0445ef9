// Runs once in every browser that opens the page. The keys themselves are commands of the page
// (see panels/drive.py); this makes the keyboard theirs, where the browser or the camera
// would take it first.
(() => {
  if (window.cartwheelPage) return;
  window.cartwheelPage = true;

  document.title = "__TITLE__";
  const style = document.createElement("style");
  style.textContent = "__STYLE__";
  document.head.appendChild(style);

  const root = document.documentElement;
  const known = new Set(__KEYS__);
  const typing = (target) =>
    target.isContentEditable || ["INPUT", "TEXTAREA", "SELECT"].includes(target.tagName);
  const press = (key) => {
    const code = /^[a-z]$/.test(key) ? "Key" + key.toUpperCase() : "";
    root.dispatchEvent(new KeyboardEvent("keydown", { key, code, bubbles: false }));
  };
  const light = (key) => {
    const cap = document.querySelector(`[data-key="${CSS.escape(key)}"]`);
    if (!cap) return;
    cap.classList.add("cw-pressed");
    setTimeout(() => cap.classList.remove("cw-pressed"), 160);
  };

  // At the root element: after the page's commands, which listen at the same place, and before
  // the camera, which listens at the document and would fly along with w, q and e.
  root.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || typing(event.target)) return;
    if (event.key.length !== 1) return;
    event.stopPropagation();
    const key = event.key.toLowerCase();
    if (known.has(key)) {
      light(key);
    } else if (known.has("k") && event.isTrusted) {
      light("k");
      press("k");
    }
  });

  // A button that was clicked keeps the focus, and space would click it again.
  root.addEventListener(
    "keydown",
    (event) => {
      if (event.key !== " " || typing(event.target)) return;
      event.preventDefault();
      if (document.activeElement && document.activeElement !== document.body) {
        document.activeElement.blur();
      }
    },
    true,
  );
  root.addEventListener(
    "keyup",
    (event) => {
      if (event.key === " " && !typing(event.target)) event.preventDefault();
    },
    true,
  );

  document.addEventListener("click", (event) => {
    const cap = event.target.closest("[data-key]");
    if (!cap) return;
    light(cap.dataset.key);
    press(cap.dataset.key);
  });
})();
