// What the page does besides its drawings: sorted tables, hints on symbols, files out of itself, links to copy, folded parts.
(() => {
  // Tables: a button in every head of a column; the last row of totals stays last.
  const value = (row, column) => {
    const cell = row.cells[column];
    const number = cell?.querySelector("data")?.getAttribute("value") ?? cell?.textContent.trim().replaceAll("−", "-") ?? "";
    return number !== "" && Number.isFinite(+number) ? +number : cell?.textContent.trim() ?? "";
  };
  const compare = (a, b) => {
    if (typeof a === "number" && typeof b === "number") return a - b;
    if (typeof a !== typeof b) return typeof a === "number" ? -1 : 1;
    return a.localeCompare(b, "en", { numeric: true });
  };
  const sort = (table, head) => {
    const column = head.cellIndex;
    const upwards = head.getAttribute("aria-sort") !== "ascending";
    for (const other of table.tHead.rows[0].cells) other.removeAttribute("aria-sort");
    head.setAttribute("aria-sort", upwards ? "ascending" : "descending");
    const body = table.tBodies[0];
    const rows = Array.from(body.rows).filter((row) => !row.classList.contains("total"));
    const keyed = rows.map((row) => ({ row, key: value(row, column) }));
    keyed.sort((a, b) => (upwards ? 1 : -1) * compare(a.key, b.key));
    body.prepend(...keyed.map(({ row }) => row));
    say(`Sorted by ${head.dataset.name}, ${upwards ? "ascending" : "descending"}`);
  };
  for (const table of all("table").filter((one) => one.tHead && one.tBodies[0]?.rows.length > 2)) {
    for (const head of table.tHead.rows[0].cells) {
      head.dataset.name = head.textContent.trim();
      const button = element("button", { type: "button", class: "sort", "aria-label": `Sort by ${head.dataset.name}` });
      head.append(button);
      head.classList.add("sortable");
      head.addEventListener("click", (event) => { if (!event.target.closest("a")) sort(table, head); });
    }
  }

  // Symbols: their meaning beside them; without script the link leads to it.
  const hint = document.body.appendChild(element("div", { class: "hint", role: "tooltip", hidden: "" }));
  const explain = (event) => {
    const term = event.target.closest?.("a.term");
    if (!term) return;
    const entry = document.getElementById(term.getAttribute("aria-describedby"));
    hint.textContent = entry ? entry.textContent.trim() : "";
    hint.hidden = !entry;
    const box = term.getBoundingClientRect();
    hint.style.left = `${Math.max(8, Math.min(box.left, innerWidth - hint.offsetWidth - 8))}px`;
    const above = box.top - hint.offsetHeight - 6;
    hint.style.top = `${above > 0 ? above : box.bottom + 6}px`;
  };
  const forget = () => { hint.hidden = true; };
  for (const kind of ["pointerover", "focusin"]) document.addEventListener(kind, explain);
  document.addEventListener("pointerout", (event) => { if (event.target.closest?.("a.term")) forget(); });
  document.addEventListener("focusout", forget);
  document.addEventListener("scroll", () => {
    const term = document.activeElement?.closest("a.term");
    const top = term?.getBoundingClientRect().top ?? -1;
    if (!hint.hidden && top > 0 && top < innerHeight) explain({ target: term });
    else forget();
  }, { passive: true });
  document.addEventListener("keydown", (event) => { if (event.key === "Escape") forget(); });

  // Files out of the page, so that it is whole without its folder.
  const save = (blob, name) => {
    const link = element("a", { href: URL.createObjectURL(blob), download: name });
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 10000);
    say(`${name} saved`);
  };
  const pixels = async (svg) => {
    const image = new Image();
    image.src = `data:image/svg+xml;charset=utf-8,${encodeURIComponent(svg)}`;
    await image.decode();
    const canvas = element("canvas");
    [canvas.width, canvas.height] = [2 * image.width, 2 * image.height];
    canvas.getContext("2d").drawImage(image, 0, 0, canvas.width, canvas.height);
    return new Promise((done) => { canvas.toBlob(done, "image/png"); });
  };
  document.addEventListener("click", async (event) => {
    const link = event.target.closest?.("a[data-save]");
    if (!link || event.ctrlKey || event.metaKey || event.shiftKey) return;
    const figure = link.closest("figure");
    const kind = link.dataset.save;
    const packed = link.dataset.packed;
    // What the page does not hold lies in the folder of the report, and is an ordinary link.
    if (!{ CSV: packed, SVG: figure.asFile, PNG: figure.asFile }[kind]) return;
    event.preventDefault();
    const name = `${figure.id.replace(/^figure-/, "")}.${kind.toLowerCase()}`;
    if (kind === "CSV") save(await unpack(packed), name);
    if (kind === "SVG") save(new Blob([figure.asFile()], { type: "image/svg+xml" }), name);
    if (kind === "PNG") save(await pixels(figure.asFile()), name);
  });

  // Figures of an earlier run over those of this one: a slider between the two, or the one in place of the other.
  const picture = (svg, name) => element("img", { src: `data:image/svg+xml;charset=utf-8,${encodeURIComponent(svg)}`, alt: name });
  const overlay = async (swap) => {
    const figure = document.getElementById(swap.dataset.now);
    const drawing = figure?.querySelector(".drawing svg");
    if (!drawing || swap.querySelector(".stack")) return;
    const copy = drawing.cloneNode(true);
    all("[data-overlay]", copy).forEach((node) => node.remove());
    copy.setAttribute("xmlns", "http://www.w3.org/2000/svg");
    const title = figure.querySelector(".title").firstChild.textContent.trim();
    const now = picture(new XMLSerializer().serializeToString(copy), `${title}, now`);
    const before = picture(await (await unpack(swap.dataset.packed)).text(), `${title}, before`);
    const stack = element("div", { class: "stack" });
    stack.append(now, before);
    const label = element("label", {}, "Now ");
    const slider = element("input", { type: "range", min: 0, max: 100, value: 50, "aria-label": `Share of ${title} shown as before` });
    label.append(slider, " Before");
    const slide = () => { before.style.clipPath = `inset(0 ${100 - slider.value}% 0 0)`; };
    slider.addEventListener("input", slide);
    const flicker = element("button", { type: "button" }, "Flicker");
    const still = matchMedia("(prefers-reduced-motion: reduce)");
    let timer = 0;
    const turn = () => { slider.value = slider.value > 50 ? 0 : 100; slide(); };
    const stop = () => { clearInterval(timer); timer = 0; flicker.textContent = "Flicker"; };
    flicker.addEventListener("click", () => {
      if (timer) { stop(); return; }
      turn();
      if (still.matches) return;
      timer = setInterval(turn, 800);
      flicker.textContent = "Stop";
    });
    swap.addEventListener("toggle", () => { if (!swap.open) stop(); });
    slider.addEventListener("pointerdown", stop);
    slide();
    const tools = element("p", { class: "slide" });
    tools.append(label, flicker);
    swap.append(tools, stack);
  };
  for (const swap of all(".swap")) {
    swap.hidden = false;
    swap.addEventListener("toggle", () => { if (swap.open) overlay(swap); });
  }

  // Links of sections and figures go to the clipboard too, where the browser lets them.
  document.addEventListener("click", async (event) => {
    const link = event.target.closest?.(".permalink");
    if (!link) return;
    try {
      await navigator.clipboard.writeText(link.href);
      link.dataset.copied = "";
      say("Link copied");
      setTimeout(() => delete link.dataset.copied, 1500);
    } catch { /* The address bar has it. */ }
  });

  // Contents beside the text are unfolded, above it they are folded.
  const contents = document.querySelector(".contents details");
  const wide = matchMedia("(min-width: 64rem)");
  const unfold = () => { contents.open = wide.matches; };
  wide.addEventListener("change", unfold);
  unfold();

  // What a link leads to is shown, and all of the page is printed.
  const reveal = () => {
    const target = location.hash.length > 1 && document.getElementById(decodeURIComponent(location.hash.slice(1)));
    if (!target) return;
    const folded = all("details").filter((one) => !one.open && (one.contains(target) || one === target));
    folded.forEach((one) => { one.open = true; });
    if (folded.length) target.scrollIntoView();
  };
  addEventListener("hashchange", reveal);
  reveal();
  let closed = [];
  addEventListener("beforeprint", () => {
    closed = all("main details:not([open])");
    closed.forEach((one) => { one.open = true; });
  });
  addEventListener("afterprint", () => { closed.forEach((one) => { one.open = false; }); });
})();
