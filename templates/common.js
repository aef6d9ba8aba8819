"use strict";
// The page without scripts has all words, numbers and drawings. What follows is shared by the scripts that add to them.
const all = (selector, root = document) => Array.from(root.querySelectorAll(selector));
const element = (name, attributes = {}, text = "") => {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  made.textContent = text;
  return made;
};
const shape = (name, attributes, parent, text = "") => {
  const made = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  made.textContent = text;
  return parent.appendChild(made);
};
const spoken = document.body.appendChild(element("div", { role: "status", class: "hidden" }));
const say = (text) => { spoken.textContent = text; };
const unpack = async (text) => {
  const bytes = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate-raw"));
  return new Response(stream).blob();
};
// The packed table of a figure as rows of cells; nothing where the page holds none.
const tableOf = async (figure) => {
  const packed = figure.querySelector("[data-packed]")?.dataset.packed;
  if (!packed) return [];
  const cells = (line) => Array.from(line.matchAll(/("(?:[^"]|"")*"|[^,]*)(?:,|$)/g), ([, cell]) =>
    (cell.startsWith('"') ? cell.slice(1, -1).replaceAll('""', '"') : cell));
  return (await (await unpack(packed)).text()).trimEnd().split("\n").map(cells);
};
