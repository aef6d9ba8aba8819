// The report in a real browser: node tests/browser/run.mjs REPORT_FOLDER HOSTILE_FOLDER OWN_FOLDER [SCREENSHOT_FOLDER]
// Every interaction, no error, no request, no sideways scroll, nothing that axe objects to, nothing that a title can run.
import assert from "node:assert/strict";
import { readFileSync, mkdirSync } from "node:fs";
import { createRequire } from "node:module";
import { join, resolve } from "node:path";
import { pathToFileURL } from "node:url";
import { chromium } from "playwright-core";

const [folder, hostile, own, pictures] = process.argv.slice(2).map((path) => resolve(path));
const axe = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");
const browser = await chromium.launch({
  executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
  args: ["--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking",
    "--disable-component-update", "--disable-sync"],
});
const DESKTOP = { width: 1280, height: 900 };
const PHONE = { width: 390, height: 844 };
let checks = 0;
const check = (condition, words) => { checks += 1; assert.ok(condition, words); };

// A page that fails the run for any error, and for any request beyond the file itself.
const open = async (path, options = {}, name = "report.html") => {
  const context = await browser.newContext({ viewport: DESKTOP, acceptDownloads: true, ...options });
  const page = await context.newPage();
  const bad = [];
  const address = pathToFileURL(join(path, name)).href;
  page.on("console", (message) => { if (["error", "warning"].includes(message.type())) bad.push(message.text()); });
  page.on("pageerror", (error) => bad.push(String(error)));
  page.on("dialog", (dialog) => { bad.push(`dialog: ${dialog.message()}`); dialog.dismiss(); });
  page.on("request", (request) => {
    const url = request.url();
    if (!url.startsWith(address) && !/^(data|blob):/.test(url)) bad.push(`request: ${url}`);
  });
  const start = performance.now();
  await page.goto(address, { waitUntil: "load" });
  page.took = performance.now() - start;
  page.finish = async () => {
    assert.deepEqual(bad, []);
    checks += 1;
    await context.close();
  };
  return page;
};
const step = async (name, run) => {
  const start = performance.now();
  await run();
  console.log(`  ${name}: ${((performance.now() - start) / 1000).toFixed(1)} s`);
};
const narrow = async (page, words) => {
  const [scroll, client] = await page.evaluate(() => [document.documentElement.scrollWidth, innerWidth]);
  check(scroll <= client, `${words}: ${scroll} px on a screen of ${client} px`);
};
const violations = async (page) => {
  await page.evaluate(axe);
  // What a drawing holds is one image with a text alternative.
  const found = await page.evaluate(() => globalThis.axe.run({ exclude: ["svg"] }, { resultTypes: ["violations"] }));
  const words = found.violations.map(({ id, nodes }) => `${id}: ${nodes.length}, e.g. ${nodes[0].html.slice(0, 200)}`);
  assert.deepEqual(words, []);
  checks += 1;
};
const picture = async (page, name, options = {}) => {
  if (!pictures) return;
  mkdirSync(pictures, { recursive: true });
  await page.screenshot({ path: join(pictures, `${name}.png`), ...options });
};
const text = (page, selector) => page.locator(selector).first().innerText();

// The first figure whose curves have names, scrolled into view.
const figure = async (page, which = "figure") => {
  const id = await page.evaluate((selector) => {
    const seen = (one) => [...one.querySelectorAll(".canvas")].find((canvas) => canvas.checkVisibility());
    const named = (one) => one.querySelectorAll("[data-key]").length > 2 && one.querySelectorAll("[data-s]").length > 2;
    const found = [...document.querySelectorAll(selector)].find((one) => named(one) && seen(one));
    seen(found).scrollIntoView({ block: "center" });
    return found.id;
  }, which);
  const root = page.locator(`[id="${id}"]`);
  await root.locator(".tools").waitFor();
  return root;
};
// Where a point of a series is on the screen.
const place = (root, share = 0.5) => root.evaluate((one, part) => {
  const svg = [...one.querySelectorAll(".drawing > svg")].find((svg) => svg.checkVisibility());
  const line = [...svg.querySelectorAll("[data-s] polyline")].find((l) => l.points.numberOfItems > 20);
  const { x, y } = line.points.getItem(Math.floor(line.points.numberOfItems * part));
  const at = new DOMPoint(x, y).matrixTransform(svg.getScreenCTM());
  return { x: at.x, y: at.y, name: line.closest("[data-s]").dataset.s };
}, share);
const zoomed = (root) => root.locator(".reset").isVisible();

try {
  await step("loads fast, in both themes and at both widths, without sideways scroll", async () => {
    const colours = [];
    for (const colorScheme of ["light", "dark"]) {
      for (const [name, viewport] of [["desktop", DESKTOP], ["phone", PHONE]]) {
        const page = await open(folder, { colorScheme, viewport });
        const { load } = await page.evaluate(() => ({ load: performance.getEntriesByType("navigation")[0].loadEventEnd }));
        check(load < 3000, `the page takes ${load} ms to open`);
        console.log(`    ${colorScheme}, ${name}: ${Math.round(load)} ms`);
        colours.push(await page.evaluate(() => getComputedStyle(document.body).backgroundColor));
        await narrow(page, `${colorScheme}, ${name}`);
        await picture(page, `${colorScheme}-${name}`);
        await page.evaluate(() => document.querySelectorAll("details").forEach((one) => { one.open = true; }));
        await narrow(page, `${colorScheme}, ${name}, unfolded`);
        await page.finish();
      }
    }
    check(new Set(colours).size === 2, "the themes look alike");
  });

  await step("the page is short, its figures follow the theme and can be read on a phone", async () => {
    const page = await open(folder, { viewport: { width: 1280, height: 800 }, colorScheme: "dark" });
    const screens = (await page.evaluate(() => document.documentElement.scrollHeight)) / 800;
    console.log(`    ${screens.toFixed(1)} screens of 1280 x 800`);
    check(screens <= 20, `${screens} screens before anything is unfolded`);
    const filter = await page.locator(".drawing > svg").first().evaluate((svg) => getComputedStyle(svg).filter);
    check(filter.includes("invert"), "figures are light in the dark theme");
    check((await text(page, ".tallies a[href='trials.html']")).length > 5, "no link to the trials");
    await page.finish();
  });

  await step("a page of one's own rig is short, and begins with the picture, the verdict and the next measurement", async () => {
    for (const name of ["explained", "unexplained", "compared"]) {
      const page = await open(join(own, name), { viewport: { width: 1280, height: 800 } });
      const root = page.locator("figure:has(.canvas)").first();
      await root.locator(".tools").waitFor();
      const screens = (await page.evaluate(() => document.documentElement.scrollHeight)) / 800;
      console.log(`    ${name}: ${screens.toFixed(1)} screens of 1280 x 800`);
      check(screens <= 8, `${name}: ${screens} screens before anything is unfolded`);
      const first = [".measured .result", ...(name === "compared" ? [] : [".measured .canvas", ".measured .next"])];
      for (const part of first) {
        const { y, height } = await page.locator(part).first().boundingBox();
        check(y + height <= 800, `${name}: ${part} ends ${y + height} px down`);
      }
      check((await page.locator(".measured h3").count()) > 0 && (await page.locator("main h2").count()) >= 3, name);
      await picture(page, `own-${name}`);
      await page.evaluate(() => document.querySelectorAll("details").forEach((one) => { one.open = true; }));
      await narrow(page, name);
      await page.finish();
    }
  });

  await step("the first picture is read on a phone as it is", async () => {
    const pages = [folder, ...["explained", "unexplained", "compared"].map((name) => join(own, name))];
    for (const [path, colorScheme] of pages.flatMap((path) => [[path, "light"], [path, "dark"]])) {
      const page = await open(path, { viewport: PHONE, colorScheme, hasTouch: true, isMobile: true });
      const root = page.locator(".measured figure").first();
      await root.scrollIntoViewIfNeeded();
      await root.locator(".tools").waitFor();
      const frame = root.locator(".canvas:visible");
      const { whole, seen, texts } = await frame.evaluate((one) => {
        const svg = one.querySelector("svg");
        const scale = svg.getBoundingClientRect().width / svg.viewBox.baseVal.width;
        const sizes = [...svg.querySelectorAll("text")].map((text) => +text.getAttribute("font-size") * scale);
        return { whole: one.scrollWidth, seen: one.clientWidth, texts: Math.min(...sizes) };
      });
      check(whole <= seen, `${path}: ${whole} px of the picture in ${seen}`);
      check(texts >= 11, `${path}: text of the first picture has ${texts} px`);
      check(!(await root.getByRole("button", { name: "Fit to width" }).isVisible()), "a button for what fits");
      await picture(page, `phone-${path.split("/").at(-1)}-${colorScheme}`);
      await page.finish();
    }
    // What was moved on one drawing begins anew on the other.
    const page = await open(join(own, "explained"), { viewport: PHONE });
    const root = page.locator(".measured figure").first();
    const line = () => root.locator(".canvas:visible").evaluate((one) =>
      [...one.querySelectorAll('[data-s="with what was found"] :is(polyline, path)')].filter((shape) => shape.style.display !== "none")
        .map((shape) => shape.getAttribute("points") ?? shape.getAttribute("d")).join());
    await root.locator(".watch").waitFor();
    const before = await line();
    await root.getByRole("slider").focus();
    await page.keyboard.press("Home");
    check((await line()) !== before, "the slider moves the narrow drawing");
    await page.setViewportSize(DESKTOP);
    await root.locator(".wide .tip").waitFor({ state: "attached" });
    await root.locator(".watch").waitFor();
    check((await root.locator(".tools").count()) === 1 && (await root.locator(".watch").count()) === 1, "tools are there twice");
    const wide = await line();
    await root.getByRole("slider").focus();
    await page.keyboard.press("Home");
    check((await line()) !== wide, "the slider moves the wide drawing");
    await page.setViewportSize(PHONE);
    await root.locator(".narrow .tip").waitFor({ state: "attached" });
    check((await line()) === before, "the narrow drawing is not as it was");
    await page.finish();
  });

  await step("the error falls: strength and switches redraw curve and number, and the number is the JSON's", async () => {
    const page = await open(folder);
    const { scenarios } = JSON.parse(readFileSync(join(folder, "report.json"), "utf8"));
    const found = scenarios.filter((one) => one.discovery?.fall);
    check(found.length >= 2, `falls: ${found.length}`);
    for (const { discovery } of found) {
      const { anchor } = discovery.figures.find((one) => one.name === "before-after");
      const root = page.locator(`[id="${anchor}"]`);
      await root.scrollIntoViewIfNeeded();
      await root.locator(".watch").waitFor();
      const slider = root.getByRole("slider");
      const curve = () => root.evaluate((one) => [...one.querySelectorAll('[data-s="with what was found"] :is(polyline, path)')]
        .filter((line) => line.style.display !== "none").map((line) => line.getAttribute("points") ?? line.getAttribute("d")).join());
      const numbers = () => root.locator("output data").evaluateAll((all) => all.map((one) => +one.value));
      const { parts, strengths } = discovery.fall;
      const whole = parts.at(-1);
      const seen = new Set([await curve()]);
      assert.deepEqual(await numbers(), [whole.chi2_per_point.at(-1), whole.rms_error_percent.at(-1)]);
      check((await slider.getAttribute("aria-valuetext")).includes("100 %"), "the slider does not say its strength");
      await slider.focus();
      for (const [back, key] of [[1, "ArrowLeft"], [2, "ArrowLeft"], [strengths.length - 1, "Home"]]) {
        await page.keyboard.press(key);
        const at = strengths.length - 1 - back;
        assert.deepEqual(await numbers(), [whole.chi2_per_point[at], whole.rms_error_percent[at]]);
        seen.add(await curve());
        checks += 1;
      }
      check(seen.size === 4, "the curve does not follow the strength");
      const legend = () => root.locator('[data-key="with what was found"] text').evaluateAll((all) => all.map((one) => one.textContent.trim()).join());
      check((await legend()).includes("0 % of what was found"), "the legend does not say that this is no strength");
      await picture(page, `fall-${anchor}`);
      await page.keyboard.press("End");
      const boxes = await root.getByRole("checkbox").all();
      check(boxes.length === whole.additions.length, "a switch for each addition");
      for (const box of boxes) await box.uncheck();
      assert.deepEqual(await numbers(), [whole.chi2_per_point[0], whole.rms_error_percent[0]]);
      for (const box of boxes) await box.check();
      check(seen.has(await curve()), "the switches do not bring the curve back");
      check((await legend()).split(",").every((text) => text === "with what was found"), `the legend of the whole: ${await legend()}`);
      check((await root.locator(".watched").innerText()).includes("Nothing is interpolated"), "what is drawn is not said");
    }
    await page.finish();
  });

  await step("a reading tells its row, its condition, the model there and the error; frequencies are linked", async () => {
    const page = await open(folder);
    await page.evaluate(() => document.querySelectorAll(".measured details").forEach((one) => { one.open = true; }));
    for (const name of ["before-after", "overlay"]) {
      const root = page.locator(`.measured figure[id$="-${name}"]`).first();
      await root.scrollIntoViewIfNeeded();
      await root.locator(".tools").waitFor();
      await page.waitForTimeout(500);
      await root.locator(".canvas:visible").evaluate((one) => one.scrollIntoView({ block: "center" }));
      const at = await root.evaluate((one) => {
        const { plot } = one;
        const { x, y } = plot.points.filter(({ group }) => group.name.startsWith("measured"))[8];
        const place = new DOMPoint(x, y).matrixTransform(plot.svg.getScreenCTM());
        return { x: place.x, y: place.y };
      });
      await page.mouse.move(at.x, at.y);
      const tip = await root.locator(".tip").innerText();
      check(/row \d+/.test(tip) && /model: /.test(tip) && /σ/.test(tip) && /measured/.test(tip), `${name}: ${tip}`);
      await picture(page, `reading-${name}`);
    }
    const [first, second] = ["overlay", "overlay-phase"].map((name) => page.locator(`.measured figure[id$="-${name}"]`).first());
    await second.scrollIntoViewIfNeeded();
    await second.locator(".tools").waitFor();
    await first.locator(".canvas:visible").focus();
    await page.keyboard.press("ArrowRight");
    await page.keyboard.press("+");
    check((await zoomed(first)) && (await zoomed(second)), "the phases do not follow the amplitudes");
    await page.keyboard.press("Escape");
    check(!(await zoomed(second)), "nor back");
    await page.finish();
  });

  await step("trials and checks have pages of their own", async () => {
    for (const name of ["trials.html", "checks.html"]) {
      const page = await open(folder, {}, name);
      check((await page.locator("h1").innerText()).length > 5 && (await page.locator("table tbody tr").count()) > 3, name);
      const [main, window] = await page.evaluate(() => [document.querySelector("main").offsetWidth, innerWidth]);
      check(main > 0.6 * window, `${name}: the text is ${main} px of ${window} px wide`);
      await narrow(page, name);
      await violations(page);
      await page.finish();
    }
  });

  await step("values under the pointer, curves on and off, zoom", async () => {
    const page = await open(folder);
    const root = await figure(page);
    const at = await place(root);
    await page.mouse.move(at.x, at.y);
    const tip = await root.locator(".tip").innerText();
    check(/\d/.test(tip) && /Hz|mm\/s|rad/.test(tip), `the tip says: ${tip}`);
    await picture(page, "hover");
    const key = root.locator("[data-key].key").first();
    const name = await key.getAttribute("data-key");
    const shown = () => root.evaluate((one, wanted) => [...one.querySelectorAll("[data-s]")]
      .filter((group) => group.dataset.s === wanted).every((group) => group.style.display !== "none"), name);
    await key.click();
    check(!(await shown()), "a click on the legend hides the curve");
    await key.click();
    check(await shown(), "a second click shows it again");
    await root.locator(".series summary").click();
    await root.locator(".series button", { hasText: name }).first().press("Enter");
    check(!(await shown()), "so does its button under the keyboard");
    await root.locator(".series button", { hasText: name }).first().press("Enter");
    const before = await root.evaluate((one) => one.querySelector("[data-s] polyline").getAttribute("points"));
    const drag = async (dx, dy) => {
      await page.mouse.move(at.x - dx, at.y - dy);
      await page.mouse.down();
      await page.mouse.move(at.x, at.y, { steps: 3 });
      await page.mouse.move(at.x + dx, at.y + dy, { steps: 3 });
      await page.mouse.up();
    };
    await root.locator(".canvas:visible").evaluate((one) => one.scrollIntoView({ block: "center" }));
    Object.assign(at, await place(root));
    await drag(60, 40);
    check(await zoomed(root), "dragging zooms");
    check((await root.locator("[data-overlay] text").count()) >= 3, "a zoomed panel has its ticks");
    await picture(page, "zoom");
    const box = await root.locator(".drawing:visible > svg").boundingBox();
    await page.mouse.dblclick(box.x + box.width / 3, box.y + box.height / 4);
    check(!(await zoomed(root)), "a double click shows the whole view");
    const after = await root.evaluate((one) => one.querySelector("[data-s] polyline").getAttribute("points"));
    assert.equal(after, before, "the whole view is as it was");
    await drag(60, 2);
    check(await zoomed(root), "dragging sideways zooms");
    await page.keyboard.press("Escape");
    check(!(await zoomed(root)), "Escape shows the whole view");
    await page.finish();
  });

  await step("the same with the keyboard alone", async () => {
    const page = await open(folder);
    const root = await figure(page);
    await root.locator(".canvas:visible").focus();
    const said = [];
    for (const key of ["ArrowRight", "ArrowRight", "ArrowDown"]) {
      await page.keyboard.press(key);
      said.push(await page.evaluate(() => [...document.querySelectorAll("[role=status]")].map((one) => one.textContent).join("")));
    }
    check(new Set(said).size === 3 && said.every((words) => /\d/.test(words)), `arrow keys say: ${said}`);
    await page.keyboard.press("+");
    check(await zoomed(root), "plus zooms");
    await page.keyboard.press("Escape");
    check(!(await zoomed(root)), "Escape shows the whole view");
    await page.finish();
  });

  await step("a zoomed panel of any figure keeps the numbers of its axes", async () => {
    const page = await open(folder);
    const bare = [];
    let seen = 0;
    await page.evaluate(() => document.querySelectorAll(".measured details").forEach((one) => { one.open = true; }));
    for (const root of await page.locator("figure:has(.canvas)").all()) {
      if (!(await root.isVisible())) continue;
      await root.locator(".canvas:visible").focus();
      await page.keyboard.press("ArrowRight");
      await page.keyboard.press("+");
      if (!(await zoomed(root))) continue;
      seen += 1;
      const numbers = await root.locator("[data-overlay] text").allTextContents();
      if (numbers.length < 2 || numbers.some((text) => text.includes("^"))) bare.push(await root.getAttribute("id"));
      await page.keyboard.press("Escape");
    }
    check(seen >= 10, `figures zoomed: ${seen}`);
    check(bare.length === 0, `without numbers: ${bare.join(", ") || "none"}`);
    await page.finish();
  });

  await step("a finger reads values too", async () => {
    const page = await open(folder, { viewport: PHONE, hasTouch: true, isMobile: true });
    const root = await figure(page);
    const at = await place(root, 0.2);
    await page.touchscreen.tap(at.x, at.y);
    check(/\d/.test(await root.locator(".tip").innerText()), "a tap reads a value");
    await picture(page, "tap");
    const swatches = await root.locator(".series .swatch").evaluateAll((all) => all.map((one) => getComputedStyle(one).borderTopColor));
    check(new Set(swatches).size > 1 && (await root.locator(".series button").first().isVisible()),
      `curves are named beside their colours: ${swatches}`);
    await page.evaluate(() => document.querySelectorAll(".measured details").forEach((one) => { one.open = true; }));
    const large = await figure(page, ".measured details figure");
    const widths = () => large.locator(".canvas:visible").evaluate((one) => [one.scrollWidth, one.clientWidth]);
    const [whole, seen] = await widths();
    check(whole > 1.5 * seen, "a phone shows what can be read");
    await picture(page, "readable");
    await large.getByRole("button", { name: "Fit to width" }).click();
    check((await widths())[0] <= seen + 1, "and on demand the whole figure");
    await picture(page, "whole");
    await large.getByRole("button", { name: "Readable size" }).click();
    check((await widths())[0] === whole, "and the readable one again");
    await page.finish();
  });

  await step("a map says the value of a colour", async () => {
    const page = await open(folder);
    for (const [name, unit] of [["misfit-map", "σ"], ["regime-map", "sticks"]]) {
      const map = page.locator(`figure[id$="-${name}"]`).first();
      await map.evaluate((one) => { for (let up = one; up; up = up.parentElement) if (up.localName === "details") up.open = true; });
      const wide = map.locator(".canvas").first();
      const cell = wide.locator("[data-area] path, [data-area] rect").last();
      await cell.scrollIntoViewIfNeeded();
      const at = await wide.locator(".drawing > svg").evaluate((svg) => {
        const [left, top, width, height] = svg.querySelector("[data-panel]").dataset.box.split(" ").map(Number);
        const matrix = svg.getScreenCTM();
        const { x, y } = new DOMPoint(left + 0.37 * width, top + 0.6 * height).matrixTransform(matrix);
        return { x, y };
      });
      await page.mouse.move(at.x, at.y);
      const tip = await map.locator(".tip").innerText();
      check(tip.includes("about ") && tip.includes(unit), `${name}: ${tip.replaceAll("\n", ", ")}`);
    }
    await page.finish();
    // On a phone the maps stand one below the other, over a lying colour bar, and show all of themselves.
    const small = await open(folder, { viewport: PHONE, hasTouch: true, isMobile: true });
    const shown = small.locator('figure[id$="-misfit-map"] .narrow').first();
    await shown.scrollIntoViewIfNeeded();
    const [whole, seen] = await shown.evaluate((one) => [one.scrollWidth, one.clientWidth]);
    check(whole <= seen + 1, `a phone shows the whole misfit map: ${whole} of ${seen} px`);
    const red = await shown.locator(".drawing > svg").evaluate((svg) => {
      const [left, top, width, height] = svg.querySelector("[data-panel]").dataset.box.split(" ").map(Number);
      // The third of 13 conditions, below the resonance.
      const { x, y } = new DOMPoint(left + 0.37 * width, top + 2.5 / 13 * height).matrixTransform(svg.getScreenCTM());
      return { x, y };
    });
    await small.touchscreen.tap(red.x, red.y);
    const said = await shown.locator(".tip").innerText();
    check(/about error: \+?[1-9]\d+ σ/.test(said), `too high there: ${said.replaceAll("\n", ", ")}`);
    await small.finish();
  });

  await step("files out of the page alone", async () => {
    const page = await open(folder);
    const root = await figure(page);
    for (const [kind, begins] of [["SVG", "<svg"], ["PNG", "\x89PNG"], ["CSV", ""]]) {
      const link = root.locator(`a[data-save=${kind}]`);
      const [download] = await Promise.all([page.waitForEvent("download"), link.click()]);
      const bytes = readFileSync(await download.path());
      check(bytes.toString("latin1").startsWith(begins) && bytes.length > 500, `${kind} of ${bytes.length} bytes`);
      check(download.suggestedFilename().endsWith(`.${kind.toLowerCase()}`), download.suggestedFilename());
      if (kind === "CSV") {
        const beside = join(folder, decodeURI(await link.getAttribute("href")));
        assert.equal(bytes.toString(), readFileSync(beside, "utf8"), "the packed table is the file beside the report");
      }
    }
    await page.finish();
  });

  await step("tables sort, symbols explain themselves, links lead and are copied", async () => {
    const page = await open(folder);
    await page.context().grantPermissions(["clipboard-read", "clipboard-write"]).catch(() => {});
    await page.evaluate(() => document.querySelectorAll("details").forEach((one) => { one.open = true; }));
    const table = page.locator("table.numbers").filter({ has: page.locator("tbody tr:nth-child(4) td data") }).first();
    const column = table.locator("thead th").last();
    const index = await column.evaluate((head) => head.cellIndex);
    const values = () => table.evaluate((one, i) => [...one.tBodies[0].rows].filter((row) => !row.className.includes("total"))
      .map((row) => +(row.cells[i]?.querySelector("data")?.value ?? NaN)).filter(Number.isFinite), index);
    await column.locator("button").press("Enter");
    const up = await values();
    assert.deepEqual(up, [...up].sort((a, b) => a - b));
    check((await column.getAttribute("aria-sort")) === "ascending", "the sort is announced");
    await column.click({ position: { x: 4, y: 4 } });
    assert.deepEqual(await values(), [...up].sort((a, b) => b - a));
    const term = page.locator("a.term:visible").first();
    await term.focus();
    check(await page.locator(".hint").isVisible(), "focus explains a symbol");
    await page.keyboard.press("Escape");
    check(!(await page.locator(".hint").isVisible()), "Escape takes the hint away");
    await term.hover();
    check((await text(page, ".hint")).length > 5, "so does the pointer");
    const link = page.locator("section .permalink").nth(1);
    check(await link.isVisible(), "links of sections are visible");
    await link.click();
    const copied = await page.evaluate(() => navigator.clipboard.readText().catch(() => location.href));
    check(copied === page.url() && copied.includes("#"), `copied: ${copied}`);
    await page.finish();
  });

  await step("a link into a folded part opens it; paper has everything", async () => {
    const page = await open(folder);
    const id = await page.evaluate(() => document.querySelector("main details:not([open]) [id]").id);
    await page.evaluate((hash) => { location.hash = hash; }, id);
    await page.locator(`[id="${id}"]`).waitFor({ state: "visible" });
    await page.evaluate(() => dispatchEvent(new Event("beforeprint")));
    check((await page.locator("main details:not([open])").count()) === 0, "everything is printed");
    await page.emulateMedia({ media: "print" });
    check(await page.locator("nav.contents").isHidden(), "contents are for the screen");
    await page.finish();
  });

  await step("readable without script", async () => {
    const page = await open(folder, { javaScriptEnabled: false });
    check((await text(page, "#summary")).length > 100, "the summary");
    check((await page.locator("figure svg").count()) > 3 && (await page.locator("math").count()) >= 0, "the drawings");
    check((await page.locator(".sort, .tools, .watch").count()) === 0, "no dead controls");
    await page.finish();
  });

  await step("nothing a scenario says can run", async () => {
    const page = await open(hostile);
    check(/<script>/.test(await page.title()) || /<script>/.test(await text(page, "main")), "the title is shown as text");
    check((await page.evaluate(() => globalThis.hacked)) === undefined, "something ran");
    check((await page.locator("main img, main script, main iframe").count()) === 0, "an element came through");
    const ran = await page.evaluate(() => {
      const script = document.body.appendChild(document.createElement("script"));
      script.textContent = "globalThis.hacked = 1";
      return globalThis.hacked;
    });
    check(ran === undefined, "the policy lets a foreign script run");
    await narrow(page, "hostile");
    await page.context().close();
    const phone = await open(hostile, { viewport: PHONE });
    await narrow(phone, "hostile, phone");
    await phone.finish();
  });

  await step("an earlier run over this one, with slider, keys and flicker; links without script", async () => {
    const page = await open(hostile);
    check((await page.locator("#baseline .changes tbody tr").count()) > 0, "no change is told");
    check((await page.locator("#history figure svg").count()) === 1, "the history is not drawn");
    const swap = page.locator(".swap").first();
    // Figures that come into view get their buttons, which moves what is below them.
    await swap.scrollIntoViewIfNeeded();
    await page.waitForTimeout(400);
    await swap.locator("summary").click();
    const before = swap.locator(".stack img").nth(1);
    await before.waitFor();
    check((await swap.locator(".stack img").evaluateAll((all) => all.every((one) => one.naturalWidth > 500))), "no drawing");
    const clip = () => before.evaluate((one) => one.style.clipPath);
    const half = await clip();
    await swap.locator("input").focus();
    await page.keyboard.press("End");
    check((await clip()) !== half && /inset\(0(px)? 0%/.test(await clip()), `the slider shows ${await clip()}`);
    const flicker = swap.locator("button");
    await flicker.click();
    check((await flicker.innerText()) === "Stop" && /100%/.test(await clip()), "the flicker does not start");
    await page.waitForTimeout(900);
    check(/inset\(0(px)? 0%/.test(await clip()), "the flicker does not turn");
    await flicker.click();
    check((await flicker.innerText()) === "Flicker", "the flicker does not stop");
    await picture(page, "baseline");
    await violations(page);
    await narrow(page, "baseline");
    await page.finish();
    const plain = await open(hostile, { javaScriptEnabled: false });
    check((await plain.locator(".swap").first().isHidden()), "a dead control");
    check((await plain.locator(".pictures a").count()) >= 2, "no links to the earlier drawings");
    await plain.finish();
  });

  await step("axe", async () => {
    for (const [colorScheme, viewport] of [["light", DESKTOP], ["dark", PHONE]]) {
      const page = await open(folder, { colorScheme, viewport });
      // One section of each kind, unfolded: the others come from the same templates.
      await page.evaluate(() => {
        const compared = [...document.querySelectorAll("section.scenario")].filter((one) => one.querySelector(".discovery"));
        const plain = [...document.querySelectorAll("section.scenario")].filter((one) => !one.querySelector(".comparison"));
        for (const list of [compared, plain, [...document.querySelectorAll("details.effect")]]) {
          list.slice(1).forEach((one) => one.remove());
        }
        document.querySelectorAll("main details").forEach((one) => { one.open = true; });
      });
      await figure(page);
      await violations(page);
      await page.finish();
    }
  });
  console.log(`${checks} checks hold`);
} finally {
  await browser.close();
}
