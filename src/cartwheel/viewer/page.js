// Runs once in every browser that opens the page. The keys themselves are commands of the page
// (see panels/drive.py); this makes the keyboard theirs, where the browser, a focused button or
// the camera would take it first.
(() => {
  if (window.cartwheelPage) return;
  window.cartwheelPage = true;

  document.title = "__TITLE__";
  const style = document.createElement("style");
  style.textContent = "__STYLE__";
  document.head.appendChild(style);

  const root = document.documentElement;
  const known = new Set(__KEYS__);
  const clicked = ["checkbox", "radio", "button", "submit", "range", "file"];
  const typing = (target) =>
    target.isContentEditable ||
    ["TEXTAREA", "SELECT"].includes(target.tagName) ||
    (target.tagName === "INPUT" && !clicked.includes(target.type));

  // Not bubbling: only the commands listen at the root itself; the camera, which would fly along
  // with w, q and e, listens further out.
  const press = (key) => {
    const cap = document.querySelector(`[data-key="${CSS.escape(key)}"]`);
    if (cap) {
      cap.classList.add("cw-pressed");
      setTimeout(() => cap.classList.remove("cw-pressed"), 160);
    }
    root.dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: false }));
  };

  const ours = (event) =>
    event.isTrusted &&
    event.key.length === 1 &&
    !(event.ctrlKey || event.metaKey || event.altKey) &&
    !typing(event.target);

  // While it is on its way down, so that no focused button or tab takes space for a click.
  root.addEventListener(
    "keydown",
    (event) => {
      if (!ours(event)) return;
      event.stopPropagation();
      event.preventDefault();
      const key = event.key.toLowerCase();
      if (known.has(key)) press(key);
      else if (known.has("k")) press("k");
    },
    true,
  );
  root.addEventListener("keyup", (event) => ours(event) && event.preventDefault(), true);

  document.addEventListener("click", (event) => {
    const cap = event.target.closest("[data-key]");
    if (cap) press(cap.dataset.key);
    // A list keeps the focus after the choice, and the next key would search in it.
    if (event.target.closest("[role=option]")) {
      setTimeout(() => document.activeElement && document.activeElement.blur(), 0);
    }
  });
})();
