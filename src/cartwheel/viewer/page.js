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
  // Lists hold their choice in an input: only while one is open do letters search in it.
  const list = (target) => target.getAttribute("aria-haspopup") === "listbox";
  const clicked = ["checkbox", "radio", "button", "submit", "range", "file"];
  const typing = (target) =>
    target.isContentEditable ||
    ["TEXTAREA", "SELECT"].includes(target.tagName) ||
    (target.tagName === "INPUT" &&
      !clicked.includes(target.type) &&
      !(list(target) && target.getAttribute("aria-expanded") !== "true"));

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
      if (document.activeElement) document.activeElement.blur(); // no frame around a stale button
      const key = event.key.toLowerCase();
      if (known.has(key)) press(key);
      else if (known.has("k")) press("k");
    },
    true,
  );
  root.addEventListener("keyup", (event) => ours(event) && event.preventDefault(), true);

  // Each command draws the buttons anew. A click between whose beginning and end that happens is
  // none for the browser, which sees two buttons; here both are the same key.
  let held = null;
  const keyOf = (element) => element?.closest?.("[data-key]")?.dataset.key ?? null;
  const pointer = (kind, handle) => document.addEventListener(kind, handle, true);
  pointer("pointerdown", (event) => {
    held = event.isPrimary && event.button === 0 ? keyOf(event.target) : null;
  });
  pointer("pointerup", (event) => {
    const key = keyOf(document.elementFromPoint(event.clientX, event.clientY));
    if (held !== null && key === held) press(key);
    held = null;
  });
  pointer("pointercancel", () => {
    held = null;
  });

  document.addEventListener("click", (event) => {
    // Without a pointer: by the keyboard, or a program such as a screen reader.
    if (event.detail === 0 && keyOf(event.target)) press(keyOf(event.target));
    // A list keeps the focus after the choice, and Ctrl+K would not be heard in it.
    if (event.target.closest("[role=option]")) {
      setTimeout(() => document.activeElement && document.activeElement.blur(), 50);
    }
  });

  // viser greys the panels of a lost connection and goes on to show their last values. A network
  // that loses everything is not even noticed: then the beat, which comes each second, stands still.
  const notice = document.createElement("div");
  notice.className = "cw-offline-notice";
  notice.setAttribute("role", "alert");
  notice.innerHTML =
    "<b>Connection lost.</b> This page shows the last state that it received. The simulation has " +
    "ended or cannot be reached. If it has ended, start it again. If the new address is the same, " +
    "this page reconnects. Otherwise, open the new address.";
  document.body.appendChild(notice);
  let beat = null;
  let drawn = performance.now();
  let silent = 0; // ms
  const longest = 10000; // ms
  // Messages are read when a picture is drawn, which takes seconds where no GPU draws it. Only
  // pictures without news count as silence, each of them for a second at most; a hidden page
  // draws none.
  const listen = () => {
    const now = performance.now();
    const news = document.querySelector("[data-beat]")?.dataset.beat ?? null;
    silent = news === beat ? silent + Math.min(now - drawn, 1000) : 0;
    beat = news;
    drawn = now;
    requestAnimationFrame(listen);
  };
  requestAnimationFrame(listen);
  const watch = () => {
    const panel = document.querySelector(".cw");
    const frozen = panel?.closest('[style*="pointer-events: none"][style*="opacity: 0.5"]');
    const lost = Boolean(frozen) || silent > longest;
    if (root.classList.contains("cw-offline") && !lost) shadow();
    root.classList.toggle("cw-offline", lost);
    // Notes stand below it.
    root.style.setProperty("--cw-notice", `${notice.getBoundingClientRect().bottom}px`);
  };
  setInterval(watch, 500);

  // Only a GPU draws shadows: without one, they double the time of each picture.
  const drawing = document.createElement("canvas").getContext("webgl2");
  const info = drawing && drawing.getExtension("WEBGL_debug_renderer_info");
  const renderer = info ? drawing.getParameter(info.UNMASKED_RENDERER_WEBGL) : "";
  if (drawing) drawing.getExtension("WEBGL_lose_context")?.loseContext();
  const shadow = () => {
    if (/swiftshader|llvmpipe|softpipe|software/i.test(renderer)) return;
    const wait = setInterval(() => {
      if (!document.querySelector("canvas[data-engine]")) return;
      clearInterval(wait);
      setTimeout(() => press("__SHADOWS__"), 1500);
    }, 100);
  };
  shadow();
})();
