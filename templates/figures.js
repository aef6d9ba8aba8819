// Drawings: values under the pointer and under the arrow keys, curves switched off, zoom, and files out of the page itself.
(() => {
  const FINE = 16; // Units of a drawing per logical pixel.
  const plots = [];
  const keys = element("p", { class: "hidden", id: "keys" }, "Left and right arrow keys read along a curve, up and down go to "
    + "another curve, plus and minus zoom, Escape returns to the whole view.");
  document.querySelector("main").append(keys);

  // Numbers: as many digits as `step` resolves.
  const written = (value, step) => {
    if (!Number.isFinite(value)) return "–";
    const decimals = Math.ceil(-Math.log10(step));
    const plain = decimals <= 6 && Math.abs(value) < 1e6;
    const digits = Math.max(1, Math.floor(Math.log10(Math.abs(value) || 1)) + decimals);
    const text = plain ? value.toFixed(Math.max(0, decimals)) : value.toExponential(Math.min(3, digits));
    const raised = (power) => Array.from(power, (sign) => (sign === "-" ? "⁻" : "⁰¹²³⁴⁵⁶⁷⁸⁹"[+sign])).join("");
    return text.replace(/e\+?(-?\d+)/, (_, power) => `×10${raised(power)}`).replaceAll("-", "−");
  };

  // An axis: shares 0 to 1 of its length, and the values there.
  class Axis {
    constructor(text, label, length) {
      const [low, high, kind, factor, stretch] = text.split(" ");
      Object.assign(this, { low: +low, high: +high, kind, factor: +factor, stretch: +stretch, length });
      const parts = /^(.*?)\s*(?:\[([^\]]*)\])?$/.exec(label);
      this.name = parts[1];
      this.unit = parts[2] && !["–", "1"].includes(parts[2]) ? parts[2] : "";
      this.key = `${low} ${high} ${kind}`;
      this.from = 0;
      this.to = 1;
    }
    value(share) {
      if (this.kind === "log") return this.low * (this.high / this.low) ** share;
      const place = this.low + (this.high - this.low) * share;
      return this.kind === "asinh" ? this.factor * Math.sinh(this.stretch * place) : place;
    }
    share(value) {
      if (this.kind === "log") return Math.log(value / this.low) / Math.log(this.high / this.low);
      const place = this.kind === "asinh" ? Math.asinh(value / this.factor) / this.stretch : value;
      return (place - this.low) / (this.high - this.low);
    }
    // Name, value, unit; nothing for rows.
    words(share, half = 0.25 / (this.length / FINE)) {
      if (this.kind === "rows") return "";
      const step = Math.abs(this.value(share + half) - this.value(share - half)) / (this.to - this.from > 0.5 ? 1 : 10);
      const unit = this.unit === "°" ? "°" : this.unit && ` ${this.unit}`;
      return `${this.name ? `${this.name}: ` : ""}${written(this.value(share), step)}${unit}`;
    }
    zoomed() { return this.from !== 0 || this.to !== 1; }
    set(from, to) {
      const least = 1e-3;
      const middle = 0.5 * (from + to);
      const half = 0.5 * Math.max(to - from, least);
      this.from = Math.max(0, middle - half);
      this.to = Math.min(1, middle + half);
    }
    // Shares of round values between the ends of the view.
    ticks(room) {
      const [a, b] = [this.value(this.from), this.value(this.to)].sort((x, y) => x - y);
      const values = [];
      if (this.kind === "lin" || this.kind === "rows" || (a > 0 && b / a < 8) || (b < 0 && a / b < 8)) {
        const rough = (b - a) / Math.max(2, room);
        const power = 10 ** Math.floor(Math.log10(rough));
        const step = power * [1, 2, 5, 10].find((digit) => digit * power >= rough * 0.999);
        for (let k = Math.ceil(a / step); k <= b / step; k += 1) values.push([k * step, step]);
      } else {
        for (let power = -12; power <= 12; power += 1) {
          for (const digit of [1, 2, 5]) for (const sign of [-1, 1]) values.push([sign * digit * 10 ** power, 10 ** power]);
        }
        if (this.kind === "asinh") values.push([0, 1]);
      }
      // What cannot be told from zero is zero.
      const nothing = this.kind === "asinh" ? this.share(0) : null;
      const shown = values.filter(([value]) => value === 0 || nothing === null || Math.abs(this.share(value) - nothing) > 1e-4);
      const inside = shown.map(([value, step]) => ({ share: this.share(value), text: written(value, step), value }))
        .filter(({ share }) => share >= this.from - 1e-9 && share <= this.to + 1e-9)
        .sort((x, y) => Math.abs(Math.log10(Math.abs(x.value) || 1)) % 1 - Math.abs(Math.log10(Math.abs(y.value) || 1)) % 1);
      const kept = [];
      const gap = 0.6 * (this.to - this.from) / Math.max(2, room);
      for (const tick of inside) if (kept.every((other) => Math.abs(other.share - tick.share) >= gap)) kept.push(tick);
      return kept;
    }
  }

  // Outlines of an element as absolute points; `null` for what is not understood.
  const outlines = (node) => {
    const number = (name) => +node.getAttribute(name);
    const list = (text) => text.trim().split(/[\s,]+/).map(Number);
    const pairs = (numbers) => numbers.flatMap((x, i) => (i % 2 ? [] : [[x, numbers[i + 1]]]));
    switch (node.localName) {
      case "circle": return [{ points: [[number("cx"), number("cy")]], closed: true, circle: true }];
      case "polyline": return [{ points: pairs(list(node.getAttribute("points"))), closed: false }];
      case "polygon": return [{ points: pairs(list(node.getAttribute("points"))), closed: true }];
      case "text": return [{ points: [[number("x"), number("y")]], closed: true, text: true }];
      case "rect": {
        const [x, y, w, h] = ["x", "y", "width", "height"].map(number);
        return [{ points: [[x, y], [x + w, y], [x + w, y + h], [x, y + h]], closed: true }];
      }
      case "path": {
        const found = [];
        let [x, y] = [0, 0];
        for (const [, command, rest] of node.getAttribute("d").matchAll(/([MLHVhvz])([^MLHVhvz]*)/g)) {
          const given = rest ? list(rest) : [];
          if (command === "z") { found.at(-1).closed = true; continue; }
          if (command === "M" || command === "L") [x, y] = given;
          if (command === "H") [x] = given;
          if (command === "V") [y] = given;
          if (command === "h") x += given[0];
          if (command === "v") y += given[0];
          if (command === "M") found.push({ points: [], closed: false });
          found.at(-1).points.push([x, y]);
        }
        return found;
      }
      default: return null;
    }
  };
  const extent = (points, i) => Math.max(...points.map((p) => p[i])) - Math.min(...points.map((p) => p[i]));
  const centre = (points) => [0, 1].map((i) => 0.5 * (Math.max(...points.map((p) => p[i])) + Math.min(...points.map((p) => p[i]))));
  const MARK = 24 * FINE; // Closed shapes up to this size are marks: they move, they do not grow.
  const isMark = (outline) => outline.closed && extent(outline.points, 0) < MARK && extent(outline.points, 1) < MARK;

  // What stands in the table of a figure about each reading that it shows: found by the place of its mark.
  const readings = (plot) => {
    const found = [];
    const factors = { Hz: 1, kHz: 1e3, MHz: 1e6 };
    tableOf(plot.figure).then(([head = [], ...rows]) => {
      const column = (start) => head.findIndex((name) => name.startsWith(start));
      const [f, model, error] = ["frequency", "model ", "error [sigma]"].map(column);
      if (head[0] !== "kind" || Math.min(f, model, error) < 0) return;
      for (const cells of rows.filter(([kind]) => kind === "reading")) {
        const [, condition, row] = cells;
        const value = +cells[f + 1];
        found.push({
          is: (panel, x, y) => {
            const [across, up] = plot.at(panel, [+cells[f] / (factors[panel.x.unit] ?? 1), value]);
            return Math.hypot(across - x, up - y) < FINE;
          },
          words: () => reading({ row, condition, f: `${cells[f]} Hz`, value, model: +cells[model], sigma: +cells[error], label: head[f + 1] }),
        });
      }
    });
    return found;
  };
  // A reading in lines: its row, its condition, what was measured, what the model says, and how far apart they are.
  const reading = ({ row, condition, f, value, model, sigma, label }) => {
    const [, name, unit] = /^(.*?)\s*(?:\[(.*)\])?$/.exec(label);
    const number = (one) => `${written(one, 10 ** (Math.floor(Math.log10(Math.abs(one) || 1)) - 3))}${unit && unit !== "1" ? ` ${unit}` : ""}`;
    return [`row ${row}`, condition, `f: ${f}`, `${name}, measured: ${number(value)}`, `model: ${number(model)}`,
      `error: ${sigma > 0 ? "+" : ""}${written(sigma, 0.1)} σ`];
  };

  // What shows a drawing: where there is one for a narrow screen too, that which is seen.
  const phone = matchMedia("screen and (max-width: 48rem)");
  const frameOf = (figure) => (phone.matches && figure.querySelector(".narrow")) || figure.querySelector(".canvas");

  // A drawing with its panels, series and view.
  class Plot {
    constructor(figure) {
      this.figure = figure;
      this.frame = frameOf(figure);
      this.drawing = this.frame.querySelector(".drawing");
      this.svg = this.drawing.querySelector("svg");
      if (figure.querySelector(".narrow")) this.pristine = this.frame.cloneNode(true);
      this.title = figure.querySelector(".title").firstChild.textContent.trim();
      this.hidden = new Set();
      this.panels = new Map(all("[data-panel]", this.svg).map((node) => [node.dataset.panel, this.panel(node)]));
      this.groups = all("[data-p]", this.svg).map((group) => this.group(group)).filter((group) => group.panel);
      this.points = this.groups.flatMap((group) => this.read(group));
      this.shades = new Map(all("[data-bar]", this.svg).flatMap((bar) => this.bar(bar)));
      this.overlay = shape("g", { "pointer-events": "none", "data-overlay": "" }, this.svg);
      this.tip = this.drawing.appendChild(element("div", { class: "tip", hidden: "" }));
      this.current = null;
      this.legend();
      this.listen();
      this.frame.setAttribute("aria-describedby", "keys");
      figure.asFile = () => this.file();
      figure.plot = this;
      plots.push(this);
      this.rows = readings(this);
    }
    panel(node) {
      const [left, top, width, height] = node.dataset.box.split(" ").map(Number);
      const { panel: id, x, y, xl, yl } = node.dataset;
      const ticks = all(`[data-ticks="${CSS.escape(id)}"]`, this.svg);
      return { id, left, top, width, height, ticks, x: new Axis(x, xl, width), y: new Axis(y, yl, height) };
    }
    group(node) {
      const panel = this.panels.get(node.dataset.p);
      const parts = all("circle, polyline, polygon, rect, path, text", node)
        .map((part) => ({ part, outlines: outlines(part), moved: part.getAttribute("transform") ?? "" }));
      return { node, panel, name: node.dataset.s ?? "", area: "area" in node.dataset, parts };
    }
    // Colours of a colour bar, and what they stand for.
    bar(node) {
      const [from, length] = node.dataset.bar.split(" ").map(Number);
      const lying = "lying" in node.dataset;
      const axis = new Axis(node.dataset.y, node.dataset.yl, length);
      const shades = all("rect", node);
      return shades.map((rect) => {
        const [begin, extent] = (lying ? ["x", "width"] : ["y", "height"]).map((name) => +rect.getAttribute(name));
        const share = (begin + 0.5 * extent - from) / length;
        return [rect.getAttribute("fill"), axis.words(lying ? share : 1 - share, 0.5 / shades.length)];
      });
    }
    // What can be read of a series: corners of its lines, middles of its marks.
    read(group) {
      if (!group.name || group.area) return [];
      const found = [];
      for (const { part, outlines: lines } of group.parts) {
        for (const { points, closed, text } of lines ?? []) {
          const dot = points.length === 2 && points[0][0] === points[1][0] && points[0][1] === points[1][1];
          if (text || (part.localName === "path" && !closed && !dot)) continue;
          if (closed || dot) found.push(centre(points));
          else if (points.length > 2) found.push(...points);
          else for (let i = 0; i <= 50; i += 1) found.push([0, 1].map((k) => points[0][k] + (points[1][k] - points[0][k]) * i / 50));
        }
      }
      return found.map(([x, y]) => ({ x, y, group }));
    }
    // Where a point of the drawing stands in the view of its panel.
    place({ left, top, width, height, x, y }, [px, py]) {
      const across = ((px - left) / width - x.from) / (x.to - x.from);
      const up = ((top + height - py) / height - y.from) / (y.to - y.from);
      return [left + width * across, top + height * (1 - up)];
    }
    redraw() {
      for (const { node, panel, parts, area } of this.groups) {
        const zoomed = panel.x.zoomed() || panel.y.zoomed();
        if (zoomed) node.setAttribute("clip-path", `url(#${this.clip(panel)})`);
        else node.removeAttribute("clip-path");
        for (const one of parts) if (one.outlines) this.move(one, panel, area, zoomed);
      }
      this.overlay.replaceChildren();
      for (const panel of this.panels.values()) {
        const zoomed = panel.x.zoomed() || panel.y.zoomed();
        for (const ticks of panel.ticks) ticks.style.display = zoomed ? "none" : "";
        if (zoomed) this.scale(panel);
      }
      this.reset.hidden = !Array.from(this.panels.values()).some((p) => p.x.zoomed() || p.y.zoomed());
      if (this.current && this.visible(this.current)) this.show(this.current);
      else this.hide();
    }
    move(one, panel, area, zoomed) {
      const { part, outlines: lines, moved } = one;
      const target = ({ points, ...rest }) => {
        if (!area && isMark({ points, ...rest })) {
          const from = centre(points);
          const to = this.place(panel, from);
          return points.map((p) => [p[0] + to[0] - from[0], p[1] + to[1] - from[1]]);
        }
        return points.map((p) => this.place(panel, p));
      };
      one.original ??= { points: part.getAttribute("points"), d: part.getAttribute("d") };
      if (lines.length === 1 && (lines[0].circle || lines[0].text || part.localName === "rect")) {
        const [to] = target(lines[0]);
        const [from] = lines[0].points;
        part.setAttribute("transform", zoomed ? `translate(${to[0] - from[0]} ${to[1] - from[1]}) ${moved}` : moved);
        if (part.localName === "rect") {
          const after = target(lines[0]);
          part.setAttribute("width", Math.abs(after[2][0] - after[0][0]));
          part.setAttribute("height", Math.abs(after[2][1] - after[0][1]));
        }
      } else if (part.localName === "path") {
        const text = lines.map((line) => `M${target(line).map((p) => p.join(",")).join("L")}${line.closed ? "z" : ""}`);
        part.setAttribute("d", zoomed ? text.join("") : one.original.d);
      } else {
        part.setAttribute("points", zoomed ? target(lines[0]).map((p) => p.join(",")).join(" ") : one.original.points);
      }
    }
    clip(panel) {
      const id = `${this.figure.id}--clip${this.frame.matches(".narrow") ? "-narrow" : ""}-${panel.id}`;
      if (!document.getElementById(id)) {
        const { left: x, top: y, width, height } = panel;
        shape("rect", { x, y, width, height }, shape("clipPath", { id }, shape("defs", {}, this.svg)));
      }
      return id;
    }
    // Ticks of a zoomed panel in place of its own; names only where it had them.
    scale(panel) {
      const { left, top, width, height, x, y } = panel;
      const shows = panel.ticks.length ? Array.from(panel.ticks, (ticks) => ticks.dataset.shows).join("") : "xy";
      const [right, bottom] = [left + width, top + height];
      const small = { "font-size": 15 * FINE, "font-family": "DejaVu Sans, Verdana, sans-serif", fill: "#222" };
      const line = (d) => shape("path", { d, stroke: "#222", "stroke-width": 1.2 * FINE, fill: "none" }, this.overlay);
      for (const { share, text } of x.kind === "rows" ? [] : x.ticks(width / FINE / 88)) {
        const at = left + width * (share - x.from) / (x.to - x.from);
        line(`M${at},${bottom}V${bottom - 6.5 * FINE}`);
        if (shows.includes("x")) shape("text", { ...small, x: at, y: bottom + 21 * FINE, "text-anchor": "middle" }, this.overlay, text);
      }
      for (const { share, text } of y.kind === "rows" ? [] : y.ticks(height / FINE / 46)) {
        const at = bottom - height * (share - y.from) / (y.to - y.from);
        line(`M${left},${at}H${left + 6.5 * FINE}`);
        if (shows.includes("y")) shape("text", { ...small, x: left - 9 * FINE, y: at + 5.4 * FINE, "text-anchor": "end" }, this.overlay, text);
      }
    }
    // Zooms a panel to shares of its axes, and every panel that shares an axis with it.
    zoom(panel, x, y) {
      const [keyX, keyY] = [panel.x.key, panel.y.key];
      for (const other of this.panels.values()) {
        if (x && other.x.key === keyX && keyX !== "rows") other.x.set(...x);
        if (y && other.y.key === keyY && other.y.kind !== "rows") other.y.set(...y);
      }
      this.redraw();
      this.lead(panel);
      say(`${this.title}: ${[panel.x, panel.y].map((axis) => this.span(axis)).filter(Boolean).join("; ")}`);
    }
    // The figures of the same section that have the same frequencies show the same part of them.
    lead({ x }) {
      const section = this.figure.closest("section");
      if (!x.name.startsWith("frequency")) return;
      for (const other of plots.filter((plot) => plot !== this && plot.figure.closest("section") === section)) {
        const same = Array.from(other.panels.values()).filter((panel) => panel.x.key === x.key);
        for (const panel of same) panel.x.set(x.from, x.to);
        if (same.length) other.redraw();
      }
    }
    span(axis) {
      const words = [axis.from, axis.to].map((share) => axis.words(share));
      return words[0] && `${words[0]} to ${words[1].replace(`${axis.name}: `, "")}`;
    }
    unzoom() {
      const zoomed = Array.from(this.panels.values()).find(({ x }) => x.zoomed());
      for (const panel of this.panels.values()) for (const axis of [panel.x, panel.y]) axis.set(0, 1);
      this.redraw();
      if (zoomed) this.lead(zoomed);
      say(`${this.title}: whole view`);
    }
    // Position of an event in the units of the drawing, and the panel there.
    locate(event) {
      const matrix = this.svg.getScreenCTM().inverse();
      const { x, y } = new DOMPoint(event.clientX, event.clientY).matrixTransform(matrix);
      const slack = 8 * FINE;
      const inside = ({ left, top, width, height }) =>
        x > left - slack && x < left + width + slack && y > top - slack && y < top + height + slack;
      return { x, y, panel: Array.from(this.panels.values()).find(inside) };
    }
    visible(point) {
      const { panel, name } = point.group;
      const across = (point.x - panel.left) / panel.width;
      const up = (panel.top + panel.height - point.y) / panel.height;
      const within = (share, axis) => share >= axis.from - 1e-3 && share <= axis.to + 1e-3;
      return !this.hidden.has(name) && within(across, panel.x) && within(up, panel.y);
    }
    nearest(at) {
      let [best, least] = [null, 40 * FINE];
      for (const point of this.points) {
        if (point.group.panel !== at.panel || !this.visible(point)) continue;
        const [x, y] = this.place(at.panel, [point.x, point.y]);
        const distance = Math.hypot(x - at.x, y - at.y);
        if (distance < least) [best, least] = [point, distance];
      }
      return best;
    }
    words(point) {
      const { x, y, group: { panel, name } } = point;
      const row = name.startsWith("measured") && this.rows.find?.((one) => one.is(panel, x, y));
      if (row) return row.words();
      const across = panel.x.words((x - panel.left) / panel.width);
      return [name, across, panel.y.words((panel.top + panel.height - y) / panel.height)].filter(Boolean);
    }
    // A curve in place of the one that a series has in a panel; without points the one that was drawn.
    replace(name, panel, points) {
      const group = this.groups.find((one) => one.name === name && one.panel === panel);
      if (!group) return;
      group.drawn ??= group.parts;
      group.line?.remove();
      for (const { part } of group.drawn) part.style.display = points ? "none" : "";
      group.parts = group.drawn;
      if (points) {
        const look = getComputedStyle(group.drawn.find(({ part }) => part.localName !== "text").part);
        const { stroke, strokeWidth } = look;
        const text = points.map((point) => point.join(",")).join(" ");
        group.line = shape("polyline", { points: text, fill: "none", stroke, "stroke-width": strokeWidth, "clip-path": `url(#${this.clip(panel)})` }, group.node);
        group.parts = [{ part: group.line, outlines: [{ points, closed: false }], moved: "" }];
      }
      this.reread(group);
    }
    // The mark of a series moved to a place.
    put(name, panel, [x, y]) {
      const group = this.groups.find((one) => one.name === name && one.panel === panel);
      for (const one of group?.parts ?? []) {
        one.part.setAttribute("cx", x);
        one.part.setAttribute("cy", y);
        one.outlines = [{ points: [[x, y]], closed: true, circle: true }];
      }
      if (group) this.reread(group);
    }
    reread(group) {
      this.points = this.points.filter((point) => point.group !== group).concat(this.read(group));
      this.redraw();
    }
    // A place in a drawing for values of a panel.
    at({ left, top, width, height, x, y }, [across, up]) {
      return [left + width * x.share(across), top + height * (1 - y.share(up))];
    }
    show(point) {
      this.ring?.remove();
      const [x, y] = this.place(point.group.panel, [point.x, point.y]);
      this.ring = shape("circle", { cx: x, cy: y, r: 6.5 * FINE, fill: "none", stroke: "#000", "stroke-width": 2 * FINE, class: "ring" }, this.overlay);
      this.note(this.words(point), x, y);
      this.current = point;
    }
    note(lines, x, y) {
      this.tip.replaceChildren(...lines.map((line, i) => element(i === 0 && lines.length > 2 ? "strong" : "span", {}, line)));
      this.tip.hidden = false;
      const box = this.svg.viewBox.baseVal;
      const [width, left] = [this.svg.clientWidth, this.svg.getBoundingClientRect().left - this.drawing.getBoundingClientRect().left];
      const at = [left + x / box.width * width, y / box.width * width];
      // Kept to what is seen of a drawing wider than the screen.
      const seen = [this.frame.scrollLeft, this.frame.scrollLeft + this.frame.clientWidth - 24];
      const beyond = at[0] + 16 + this.tip.offsetWidth > seen[1];
      const wanted = beyond ? at[0] - 16 - this.tip.offsetWidth : at[0] + 16;
      this.tip.style.left = `${Math.max(seen[0], Math.min(wanted, seen[1] - this.tip.offsetWidth))}px`;
      this.tip.style.top = `${Math.max(0, at[1] - this.tip.offsetHeight - 8)}px`;
    }
    hide() {
      this.tip.hidden = true;
      this.ring?.remove();
      this.current = null;
    }
    toggle(name) {
      const off = !this.hidden.delete(name);
      if (off) this.hidden.add(name);
      for (const { node, name: own } of this.groups) if (own === name) node.style.display = off ? "none" : "";
      for (const key of this.keys.filter((node) => node.dataset.key === name)) key.style.opacity = off ? 0.35 : "";
      for (const button of this.buttons.filter((one) => one.textContent === name)) button.setAttribute("aria-pressed", String(!off));
      if (this.current && this.hidden.has(this.current.group.name)) this.hide();
      say(`${name}: ${off ? "hidden" : "shown"}`);
    }
    legend() {
      const names = Array.from(new Set(this.groups.map((group) => group.name).filter(Boolean)));
      this.keys = all("[data-key]", this.svg).filter((node) => names.includes(node.dataset.key));
      for (const key of this.keys) {
        key.classList.add("key");
        const { x, y, width, height } = key.getBBox();
        shape("rect", { x, y, width, height, fill: "transparent" }, key);
        key.addEventListener("click", () => this.toggle(key.dataset.key));
      }
      this.buttons = names.map((name) => element("button", { type: "button", "aria-pressed": "true" }, name));
      for (const button of this.buttons) {
        button.prepend(this.swatch(button.textContent));
        button.addEventListener("click", () => this.toggle(button.textContent));
      }
      this.reset = element("button", { type: "button", class: "reset", hidden: "" }, "Whole view");
      this.reset.addEventListener("click", () => { this.unzoom(); this.frame.focus(); });
      // A phone shows what can be read, and scrolls; the whole figure on demand.
      this.fit = element("button", { type: "button", hidden: "" }, "Fit to width");
      const turn = () => { this.fit.textContent = this.drawing.classList.toggle("whole") ? "Readable size" : "Fit to width"; };
      this.fit.addEventListener("click", turn);
      new ResizeObserver(() => {
        const wider = this.frame.scrollWidth > this.frame.clientWidth + 1;
        this.fit.hidden = !wider && !this.drawing.classList.contains("whole");
      }).observe(this.frame);
      const tools = element("div", { class: "tools" });
      tools.append(this.reset, this.fit);
      if (names.length > 1) {
        const list = element("details", { class: "series" });
        // Where a legend may lie beyond the screen, this stands for it.
        list.open = matchMedia("(max-width: 48rem)").matches && names.length <= 8;
        const group = element("div", { role: "group", "aria-label": `Curves of ${this.title}` });
        group.append(...this.buttons);
        list.append(element("summary", {}, `Show or hide curves (${names.length})`), group);
        tools.append(list);
      }
      this.frame.after(tools);
    }
    // A piece of line like that of a series.
    swatch(name) {
      const parts = this.groups.filter((group) => group.name === name).flatMap((group) => group.parts);
      const made = element("span", { class: "swatch" });
      for (const { stroke, fill, strokeDasharray } of parts.map(({ part }) => getComputedStyle(part))) {
        const color = [stroke, fill].find((one) => one !== "none" && one !== "rgb(255, 255, 255)");
        if (!color) continue;
        made.style.borderTop = `4px ${strokeDasharray === "none" ? "solid" : "dashed"} ${color}`;
        break;
      }
      return made;
    }
    // What is at a place: the nearest point of a curve, or else where it is on the axes.
    look(event, at) {
      const point = at.panel && this.nearest(at);
      if (point) this.show(point);
      else this.hide();
      if (point || !at.panel || event.target.closest(".key")) return;
      const { x, y, left, top, width, height } = at.panel;
      const across = x.words(x.from + (at.x - left) / width * (x.to - x.from));
      const up = y.words(y.from + (top + height - at.y) / height * (y.to - y.from));
      const shade = event.target.closest("[data-area]") && this.shades.get(event.target.getAttribute("fill"));
      const lines = [shade && `about ${shade}`, across, up].filter(Boolean);
      if (lines.length) this.note(lines, at.x, at.y);
    }
    listen() {
      const svg = this.svg;
      let start = null;
      let band = null;
      svg.addEventListener("pointerdown", (event) => {
        const at = this.locate(event);
        if (event.pointerType === "touch" || event.button !== 0 || !at.panel || event.target.closest(".key")) return;
        start = at;
        svg.setPointerCapture(event.pointerId);
        event.preventDefault();
        this.frame.focus({ preventScroll: true });
      });
      svg.addEventListener("pointermove", (event) => {
        const at = this.locate(event);
        if (start) {
          band ??= shape("rect", { fill: "#0072b2", "fill-opacity": 0.15, stroke: "#0072b2", "stroke-width": FINE }, this.overlay);
          const [a, b] = this.corners(start, at);
          const box = { x: a[0], y: a[1], width: b[0] - a[0], height: b[1] - a[1] };
          for (const [key, value] of Object.entries(box)) band.setAttribute(key, value);
        } else this.look(event, at);
      });
      svg.addEventListener("click", (event) => this.look(event, this.locate(event)));
      const finish = (event) => {
        band?.remove();
        band = null;
        if (!start) return;
        const [[x0, y0], [x1, y1], panel] = [...this.corners(start, this.locate(event)), start.panel];
        start = null;
        const share = (low, high, from, length, axis) =>
          [low, high].map((at) => axis.from + (at - from) / length * (axis.to - axis.from));
        if (Math.max(x1 - x0, y1 - y0) < 8 * FINE) return;
        const across = share(x0, x1, panel.left, panel.width, panel.x);
        const up = share(panel.top + panel.height - y1, panel.top + panel.height - y0, 0, panel.height, panel.y);
        this.zoom(panel, x1 - x0 > 8 * FINE && across, y1 - y0 > 8 * FINE && up);
      };
      svg.addEventListener("pointerup", finish);
      svg.addEventListener("pointercancel", () => { start = null; band?.remove(); band = null; });
      svg.addEventListener("pointerleave", () => { if (!start) this.hide(); });
      svg.addEventListener("dblclick", () => this.unzoom());
      this.frame.addEventListener("blur", () => this.hide());
      this.frame.addEventListener("keydown", (event) => this.key(event));
    }
    // Corners of a rectangle drawn from one place to another, kept to the panel where it began.
    corners(start, end) {
      const { left, top, width, height } = start.panel;
      const x = [start.x, end.x].map((at) => Math.min(left + width, Math.max(left, at))).sort((a, b) => a - b);
      const y = [start.y, end.y].map((at) => Math.min(top + height, Math.max(top, at))).sort((a, b) => a - b);
      return [[x[0], y[0]], [x[1], y[1]]];
    }
    key(event) {
      const step = { ArrowRight: 1, ArrowLeft: -1, ArrowDown: 2, ArrowUp: -2 }[event.key];
      if (event.target !== this.frame || event.ctrlKey || event.metaKey || event.altKey) return;
      if (event.key === "Escape" || event.key === "0") { this.hide(); this.unzoom(); return; }
      if (["+", "=", "-"].includes(event.key)) {
        const panel = this.current?.group.panel ?? this.panels.values().next().value;
        if (!panel) return;
        const factor = event.key === "-" ? 1 : 0.25;
        const { x, left, width } = panel;
        const middle = this.current ? (this.current.x - left) / width : 0.5 * (x.from + x.to);
        const half = factor * (x.to - x.from);
        this.zoom(panel, [middle - half, middle + half]);
        event.preventDefault();
        return;
      }
      if (!step || !this.points.length) return;
      event.preventDefault();
      const visible = this.points.filter((point) => this.visible(point));
      const rank = (point) => Array.from(this.panels.keys()).indexOf(point.group.panel.id);
      const names = Array.from(new Set(visible.map((point) => point.group.name)));
      const line = (name) => visible.filter((p) => p.group.name === name).sort((a, b) => rank(a) - rank(b) || a.x - b.x);
      let next = line(names[0])[0];
      if (this.current && Math.abs(step) === 1) {
        const own = line(this.current.group.name);
        next = own[Math.min(own.length - 1, Math.max(0, own.indexOf(this.current) + step))];
      } else if (this.current) {
        const index = (names.indexOf(this.current.group.name) + Math.sign(step) + names.length) % names.length;
        const away = (p) => Math.abs(p.x - this.current.x) + 1e6 * Math.abs(rank(p) - rank(this.current));
        next = line(names[index]).sort((a, b) => away(a) - away(b))[0];
      }
      if (!next) return;
      this.show(next);
      say(this.words(next).join(", "));
    }
    // The drawing as the page brought it, without anything that was added to it.
    end() {
      all(".watch, .watched, .tools", this.figure).forEach((node) => node.remove());
      this.frame.replaceWith(this.pristine);
      plots.splice(plots.indexOf(this), 1);
    }
    // The drawing as it is seen, as a file.
    file() {
      const copy = this.svg.cloneNode(true);
      all("[data-overlay] .ring", copy).forEach((node) => node.remove());
      copy.setAttribute("xmlns", "http://www.w3.org/2000/svg");
      return new XMLSerializer().serializeToString(copy);
    }
  }

  // The fall of the error: the curves of the first picture redrawn from what was solved, for a strength and a part of what was
  // found. Nothing is read between two solutions.
  const [AFTER, FALL, HERE] = ["with what was found", "error on the way", "error at this strength"];
  const watch = (plot, rows) => {
    const [head, ...body] = rows;
    const row = (start) => body.find(([what]) => what.startsWith(start))?.slice(4) ?? [];
    const [where, conditions, f, measured, sd] = ["panel", "condition", "frequency", "measured ", "sd"].map(row);
    const label = body.find(([what]) => what.startsWith("measured "))?.[0].slice(9) ?? "";
    const parts = new Map();
    for (const [what, strength, chi2, error, ...values] of body.filter(([, strength]) => strength !== "")) {
      if (!parts.has(what)) parts.set(what, []);
      parts.get(what).push({ strength: +strength, chi2: +chi2, error: +error, values });
    }
    const panels = Array.from(plot.panels.values());
    const place = where.map((number) => panels[number - 1]);
    const whole = Array.from(parts.keys()).at(-1);
    let now = whole && parts.get(whole).at(-1);
    const model = (i) => (now ? +now.values[i] : NaN);
    plot.rows = where.map((_, i) => ({
      is: (panel, x, y) => panel === place[i] && Math.hypot(...plot.at(panel, [+f[i], +measured[i]]).map((one, k) => one - [x, y][k])) < FINE,
      words: () => {
        const told = reading({ row: head[i + 4].replace("row ", ""), condition: conditions[i], f: `${f[i]} ${place[i].x.unit}`,
          value: +measured[i], model: model(i), sigma: (model(i) - measured[i]) / sd[i], label });
        return now ? told : told.slice(0, 4);
      },
    }));
    if (!whole) return;
    const names = whole.split(" + ");
    const box = element("div", { class: "watch", role: "group", "aria-label": "Watch the error fall" });
    const label1 = element("label", { class: "strength" }, "Strength ");
    const last = parts.get(whole).length - 1;
    const slider = label1.appendChild(element("input", { type: "range", min: 0, max: last, step: 1, value: last }));
    const switches = names.map((name) => {
      const one = element("label", { class: "switch" });
      const input = one.appendChild(element("input", { type: "checkbox", checked: "", value: name }));
      one.append(` ${name}`);
      return { one, input };
    });
    const output = element("output", { "aria-live": "polite" });
    const note = element("p", { class: "small watched" }, `Curves are solutions of the model at ${last + 1} strengths, at the readings' frequencies: all parameters `
      + "change in equal steps from the calibrated model to the fit. Nothing is interpolated between two laws.");
    box.append(label1, ...switches.map(({ one }) => one), output);
    const data = (value, text) => element("data", { value }, text);
    const digits = (value) => written(value, 10 ** (Math.floor(Math.log10(value || 1)) - 2));
    const draw = () => {
      const chosen = switches.filter(({ input }) => input.checked).map(({ input }) => input.value).join(" + ");
      const states = parts.get(chosen);
      now = states ? states[slider.value] : parts.get(whole)[0];
      slider.disabled = !states;
      const { strength, chi2, error } = now;
      const drawn = chosen === whole && strength === 100;
      for (const panel of new Set(place)) {
        const points = place.map((one, i) => [one, i]).filter(([one, i]) => one === panel && now.values[i] !== "")
          .map(([, i]) => [+f[i], +now.values[i]]).sort((a, b) => a[0] - b[0]);
        plot.replace(AFTER, panel, drawn ? null : points.map((point) => plot.at(panel, point)));
      }
      const side = panels.find((panel) => panel.x.name === "strength");
      const path = (states ?? parts.get(whole)).map((state) => plot.at(side, [state.strength, state.chi2]));
      plot.replace(FALL, side, path);
      plot.put(HERE, side, plot.at(side, [states ? strength : 0, chi2]));
      const of = states ? `${strength} % of ${chosen}` : "nothing added";
      output.replaceChildren(`${of}: χ² per reading `, data(chi2, digits(chi2)), ", error of the amplitude ", data(error, digits(error)), " %");
      slider.setAttribute("aria-valuetext", output.textContent);
      const legend = plot.keys.find((node) => node.dataset.key === AFTER)?.querySelector("text");
      const part = chosen === whole ? `${strength} % of what was found` : "part of what was found";
      if (legend) legend.textContent = drawn ? AFTER : states ? part : "nothing added";
    };
    slider.addEventListener("input", draw);
    for (const [k, { input }] of switches.entries()) {
      input.addEventListener("change", () => {
        // Of many additions only those are solved together that the ladder passes.
        if (parts.size < 2 ** names.length - 1) switches.forEach(({ input: other }, i) => { other.checked = input.checked ? i <= k : i < k; });
        draw();
      });
    }
    plot.figure.querySelector(".tools").before(box, note);
    draw();
  };

  const begin = async (figure) => {
    const plot = new Plot(figure);
    if (!figure.classList.contains("before-after")) return;
    const rows = await tableOf(figure);
    if (rows.length && figure.plot === plot) watch(plot, rows);
  };
  const near = new IntersectionObserver((entries) => {
    for (const { isIntersecting, target } of entries) {
      if (!isIntersecting) continue;
      near.unobserve(target);
      begin(target);
    }
  }, { rootMargin: "300px" });
  // A screen that was turned shows the other drawing.
  phone.addEventListener("change", () => plots.filter((plot) => plot.pristine).forEach((plot) => {
    plot.end();
    begin(plot.figure);
  }));
  all("figure").filter((figure) => figure.querySelector(".drawing svg")).forEach((figure) => near.observe(figure));
})();
