// The report in a real browser. Usage: node --test report.test.mjs, with REPORTS=a.html:b.html and CHROMIUM=/path/to/chromium; PAGES=c.html are
// pages of other kinds, PICTURES=folder those of commands without a page.
// Truth: what a reader sees - sizes and boxes as laid out, requests as sent, pages as printed, rules of accessibility as axe-core has them.
import assert from "node:assert/strict";
import { readFileSync, readdirSync, mkdirSync } from "node:fs";
import { createRequire } from "node:module";
import { basename, resolve } from "node:path";
import { pathToFileURL } from "node:url";
import { after, before, describe, test } from "node:test";
import { chromium } from "playwright-core";
import { getDocument } from "pdfjs-dist/legacy/build/pdf.mjs";

const axe = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");
const reports = (process.env.REPORTS ?? "").split(":").filter(Boolean).map((file) => resolve(file));
const shots = process.env.SHOTS;
const switches = ["--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync"];
const desktop = { width: 1280, height: 900 };
// A4 without the margins of the style sheet, in CSS pixels.
const paper = { width: Math.round((210 - 26) / 25.4 * 96), height: Math.round((297 - 32) / 25.4 * 96) };

// Pages of other kinds, and folders of pictures without a page.
const listed = (name) => (process.env[name] ?? "").split(":").filter(Boolean).map((file) => resolve(file));
const [pages, folders] = [listed("PAGES"), listed("PICTURES")];
assert.ok(reports.length > 0, "REPORTS names no report");
let browser;
before(async () => { browser = await chromium.launch({ executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium", args: switches }); });
after(async () => { await browser?.close(); });

async function open(file, options = {}) {
  const context = await browser.newContext({ viewport: desktop, bypassCSP: true, ...options });
  const page = await context.newPage();
  const heard = { console: [], requests: [] };
  page.on("console", (message) => { if (["error", "warning"].includes(message.type())) heard.console.push(message.text()); });
  page.on("pageerror", (error) => heard.console.push(String(error)));
  page.on("request", (request) => { if (!request.url().startsWith("data:")) heard.requests.push(request.url()); });
  await page.goto(pathToFileURL(file).href);
  return { context, page, heard };
}

// Texts of every drawing that overlap another text or leave the drawing.
const badTexts = () => {
  const bad = [];
  for (const figure of document.querySelectorAll("figure.figure")) {
    if (!figure.checkVisibility()) continue;
    // A figure may have a drawing for a narrow screen next to the wide one: the one that is shown.
    const svg = [...figure.querySelectorAll(".drawing svg")].find((one) => one.checkVisibility());
    if (!svg) { bad.push(`${figure.id}: no drawing`); continue; }
    const frame = svg.getBoundingClientRect();
    const scale = frame.width / svg.viewBox.baseVal.width;
    // The box has the line height of the font, with empty space of half the letter height on either side.
    const boxes = [...svg.querySelectorAll("text")].filter((text) => text.textContent.trim() && text.checkVisibility()).map((text) => {
      const box = text.getBoundingClientRect();
      const upright = box.height > box.width && text.textContent.length > 1;
      const air = { x: upright ? box.width * 0.2 : 0.5, y: upright ? 0.5 : box.height * 0.2 };
      return { words: text.textContent, left: box.left + air.x, right: box.right - air.x, top: box.top + air.y, bottom: box.bottom - air.y };
    });
    for (const [k, one] of boxes.entries()) {
      if (one.left < frame.left - 1 || one.right > frame.right + 1 || one.top < frame.top - 1 || one.bottom > frame.bottom + 1) {
        bad.push(`${figure.id}: "${one.words}" leaves the drawing`);
      }
      for (const other of boxes.slice(k + 1)) {
        const wide = Math.min(one.right, other.right) - Math.max(one.left, other.left);
        const tall = Math.min(one.bottom, other.bottom) - Math.max(one.top, other.top);
        if (wide > 0.5 && tall > 0.5) bad.push(`${figure.id}: "${one.words}" on "${other.words}"`);
      }
    }
    if (!(scale > 0)) bad.push(`${figure.id}: no size`);
  }
  return bad;
};

// Words of the page that are broken between two letters or digits in the layout. A break is allowed at a space, after the joint of
// a key, or at a hyphen.
const cutWords = () => {
  const cut = [];
  const range = document.createRange();
  const letter = /[\p{L}\p{N}]/u;
  const texts = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  for (let node = texts.nextNode(); node; node = texts.nextNode()) {
    if (!node.parentElement.checkVisibility() || node.parentElement.closest("svg, script, style, .skip")) continue;
    const text = node.data;
    for (const word of text.matchAll(/\S+/g)) {
      const [from, to] = [word.index, word.index + word[0].length];
      range.setStart(node, from);
      range.setEnd(node, to);
      if (range.getClientRects().length < 2) continue;
      for (let k = from + 1; k < to; k += 1) {
        if (!letter.test(text[k - 1]) || !letter.test(text[k])) continue;
        const top = (at) => { range.setStart(node, at); range.setEnd(node, at + 1); return range.getBoundingClientRect().top; };
        if (Math.abs(top(k) - top(k - 1)) > 3) cut.push(`${text.slice(from, k)}/${text.slice(k, to)}`);
      }
    }
  }
  return cut;
};

for (const file of reports) {
  describe(basename(file), () => {
    test("loads without a message on the console and requests only itself", async () => {
      const { context, heard } = await open(file, { bypassCSP: false });
      assert.deepEqual(heard.console, []);
      assert.deepEqual(heard.requests, [pathToFileURL(file).href]);
      await context.close();
    });

    test("figures have a size, and no text lies on another or outside", async () => {
      for (const options of [{}, { viewport: { width: 390, height: 844 }, isMobile: true }, { viewport: paper }]) {
        const { context, page } = await open(file, options);
        const sizes = await page.$$eval(".drawing svg", (all) => all.filter((svg) => svg.checkVisibility()).map((svg) => { const box = svg.getBoundingClientRect(); return Math.min(box.width, box.height); }));
        assert.ok(sizes.length > 0 && sizes.every((size) => size > 60), `${sizes}`);
        assert.deepEqual(await page.evaluate(badTexts), []);
        // The sans-serif font of another machine may be wider.
        const wide = await page.addStyleTag({ content: 'svg text { font-family: "DejaVu Sans" }' });
        assert.deepEqual(await page.evaluate(badTexts), [], "in a wide face");
        await wide.evaluate((style) => style.remove());
        const over = await page.evaluate(() => document.documentElement.scrollWidth - document.documentElement.clientWidth);
        assert.ok(over <= 0, `the page is ${over} px too wide at ${JSON.stringify(options)}`);
        if (shots) {
          mkdirSync(shots, { recursive: true });
          await page.screenshot({ path: `${shots}/${basename(file, ".html")}_${page.viewportSize().width}.png`, fullPage: true });
        }
        await context.close();
      }
    });

    test("no word is cut, and no table is clipped", async () => {
      for (const [viewport, media] of [[{ width: 1400, height: 900 }, "screen"], [{ width: 1200, height: 900 }, "screen"], [{ width: 390, height: 844 }, "screen"], [paper, "print"]]) {
        const { context, page } = await open(file, { viewport });
        await page.emulateMedia({ media });
        assert.deepEqual(await page.evaluate(cutWords), [], `${media} ${viewport.width}`);
        const wide = await page.$$eval("table, dl", (all) => all.filter((t) => t.checkVisibility() && !(getComputedStyle(t.parentElement).overflowX === "auto"))
          .map((t) => [t.getBoundingClientRect().right - document.documentElement.clientWidth, t.caption?.textContent ?? "facts"]).filter(([over]) => over > 1));
        assert.deepEqual(wide, [], `${media} ${viewport.width}`);
        await context.close();
      }
    });

    test("text on A4 is large enough to read", async () => {
      const { context, page } = await open(file, { viewport: paper });
      await page.emulateMedia({ media: "print" });
      // 6 pt are 8 px; smaller text cannot be read on paper.
      const small = await page.$$eval(".drawing svg", (all) => all.filter((svg) => svg.checkVisibility()).flatMap((svg) => {
        const scale = svg.getBoundingClientRect().width / svg.viewBox.baseVal.width;
        return [...svg.querySelectorAll("text")].map((text) => [parseFloat(getComputedStyle(text).fontSize) * scale, text.textContent]).filter(([size]) => size < 8);
      }));
      assert.deepEqual(small.slice(0, 5), []);
      await context.close();
    });

    test("tables are one click away, with as many cells as heads", async () => {
      const { context, page } = await open(file);
      for (const figure of await page.$$("figure.figure")) {
        if (!(await figure.isVisible())) continue;
        const summary = await figure.$("details.data > summary");
        const table = await figure.$("details.data table");
        assert.equal(await table.isVisible(), false);
        await summary.click();
        assert.equal(await table.isVisible(), true);
        const shape = await table.evaluate((t) => ({ heads: t.tHead.rows[0].cells.length, cells: [...t.tBodies[0].rows].map((row) => row.cells.length) }));
        assert.ok(shape.cells.length > 0 && shape.cells.every((n) => n === shape.heads), JSON.stringify(shape).slice(0, 200));
        await summary.click();
      }
      await context.close();
    });

    test("pointing at a figure shows its numbers, by mouse and by keyboard", async () => {
      const { context, page } = await open(file);
      const tip = page.locator(".tip");
      for (const figure of await page.$$("figure.figure")) {
        if (!(await figure.isVisible())) continue;
        const id = await figure.getAttribute("id");
        const target = await figure.evaluate((f) => {
          f.scrollIntoView({ block: "center", behavior: "instant" });
          const panel = f.querySelector("rect.plot[data-x0]");
          const mark = [...f.querySelectorAll("svg [data-row]")].sort((a, b) => { const s = (e) => { const r = e.getBoundingClientRect(); return r.width * r.height; }; return s(b) - s(a); })[0];
          const box = (panel ?? mark)?.getBoundingClientRect();
          return box && { x: box.left + box.width / 2, y: box.top + box.height / 2, panel: Boolean(panel) };
        });
        assert.ok(target, `${id}: nothing to point at`);
        await page.mouse.move(target.x, target.y);
        // A mark may be a line or hollow in its middle. The keyboard reaches every row nevertheless.
        if (target.panel) assert.ok(await tip.isVisible(), `${id}: no numbers under the pointer`);
        await page.mouse.move(1, 1);
        await figure.$eval(".drawing", (d) => d.focus({ preventScroll: true }));
        await page.keyboard.press("ArrowRight");
        assert.ok(await tip.isVisible(), `${id}: no numbers by keyboard`);
        assert.match(await tip.innerText(), /\S+/);
        const row = await figure.$eval("details.data tbody tr", (tr) => [...tr.cells].map((c) => c.textContent).filter(Boolean));
        const said = await tip.innerText();
        assert.ok(row.every((cell) => said.includes(cell)), `${id}: ${said} / ${row}`);
        await page.keyboard.press("Escape");
        assert.equal(await tip.isVisible(), false);
      }
      await context.close();
    });

    test("figures over time share one cursor and one part of the time", async () => {
      const { context, page, heard } = await open(file);
      const traces = await page.$$eval("figure.figure", (all) => all.filter((f) => f.checkVisibility() && f.querySelector("rect.plot[data-x0]") && f.querySelector("details thead th .unit")?.textContent === "[s]").map((f) => f.id));
      if (traces.length > 1) {
        const first = page.locator(`[id="${traces[0]}"]`);
        await first.scrollIntoViewIfNeeded();
        const box = await first.locator("rect.plot").first().boundingBox();
        await page.mouse.move(box.x + box.width * 0.3, box.y + box.height / 2);
        const lit = await page.$$eval("figure.figure", (all) => all.filter((f) => f.querySelector("svg .cursor")).map((f) => f.id));
        assert.deepEqual(lit, traces);
        const paths = () => page.$$eval("figure.figure", (all, ids) => all.filter((f) => ids.includes(f.id)).map((f) => [...f.querySelectorAll("svg path[d]")].map((path) => path.getAttribute("d")).join()), traces);
        const whole = await paths();
        await page.mouse.down();
        await page.mouse.move(box.x + box.width * 0.5, box.y + box.height / 2, { steps: 4 });
        await page.mouse.up();
        const part = await paths();
        assert.ok(part.every((own, k) => own !== whole[k]), "all figures show the part");
        assert.deepEqual(await page.evaluate(badTexts), []);
        await first.locator("button.csv", { hasText: "Whole cycle" }).click();
        assert.deepEqual(await paths(), whole);
      }
      assert.deepEqual(heard.console, []);
      await context.close();
    });

    test("one switch shows the figures of another car, and is found again in print and without scripts", async () => {
      const { context, page, heard } = await open(file);
      const shown = () => page.$$eval("figure.figure[data-view]", (all) => all.filter((f) => f.checkVisibility()).map((f) => [f.dataset.group, f.dataset.view]));
      const groups = await page.$$eval("figure.figure[data-view]", (all) => { const of = {}; for (const f of all) (of[f.dataset.group] ??= []).push(f.dataset.view); return of; });
      for (const bar of Object.keys(groups).length ? [page.locator(".views").first()] : []) {
        for (const label of await bar.locator("button").allTextContents()) {
          await bar.locator("button", { hasText: new RegExp(`^${label}$`) }).click();
          const wanted = Object.entries(groups).map(([group, views]) => [group, views.includes(label) ? label : views[0]]);
          assert.deepEqual(await shown(), wanted, `one figure of each group, that of ${label}`);
          assert.deepEqual(await page.$$eval('.views button[aria-pressed="true"]', (all) => [...new Set(all.map((b) => b.textContent))]), [label]);
          assert.deepEqual(await page.evaluate(badTexts), []);
        }
      }
      assert.deepEqual(heard.console, []);
      await context.close();
      const still = await open(file, { javaScriptEnabled: false });
      const summaries = await still.page.locator("details.view > summary").count();
      assert.equal(summaries, Object.values(groups).reduce((sum, views) => sum + views.length - 1, 0));
      if (summaries) {
        await still.page.locator("details.view > summary").first().click();
        assert.ok(await still.page.locator("details.view figure .drawing svg").first().isVisible());
      }
      await still.context.close();
    });

    test("a component is lit wherever it is, and the numbers of a figure can be saved", async () => {
      const { context, page } = await open(file);
      const mark = page.locator("#fig-loss_by_component svg rect[data-row], #fig-loss_by_component svg path[data-row]").first();
      if (await mark.count()) {
        await mark.scrollIntoViewIfNeeded();
        await mark.hover({ force: true });
        const names = await page.$$eval("tr.lit", (all) => [...new Set(all.map((row) => [...row.cells].slice(0, 2).map((cell) => cell.textContent.toLowerCase()).find((text) => document.querySelector("main").dataset.components.split(",").includes(text))))]);
        assert.equal(names.length, 1, `${names}`);
        assert.ok(await page.locator("svg .lit").count() > 1);
      }
      const figure = page.locator("figure.figure").first();
      const [saved] = await Promise.all([page.waitForEvent("download"), figure.locator("button.csv", { hasText: "CSV" }).click()]);
      const lines = readFileSync(await saved.path(), "utf8").trimEnd().split("\r\n");
      assert.equal(lines.length, 1 + await figure.locator("details tbody tr").count());
      assert.equal(saved.suggestedFilename(), `${(await figure.getAttribute("id")).replace("fig-", "")}.csv`);
      await context.close();
    });

    test("the page can be light and dark", async () => {
      const { context, page } = await open(file, { colorScheme: "light" });
      const lightness = () => page.evaluate(() => {
        const sum = (colour) => colour.match(/[\d.]+/g).slice(0, 3).reduce((s, x) => s + Number(x), 0);
        const text = document.querySelector(".drawing svg text");
        return { page: sum(getComputedStyle(document.body).backgroundColor), text: sum(getComputedStyle(text).fill) };
      });
      const light = await lightness();
      await page.click("button.theme");
      const dark = await lightness();
      assert.ok(light.page > 600 && dark.page < 150, JSON.stringify({ light, dark }));
      assert.ok(light.text < 300 && dark.text > 450, "the drawings follow");
      if (shots) await page.screenshot({ path: `${shots}/${basename(file, ".html")}_dark.png`, fullPage: true });
      await page.click("button.theme");
      assert.deepEqual(await lightness(), light);
      await context.close();
    });

    test("everything is there without scripts", async () => {
      const { context, page } = await open(file, { javaScriptEnabled: false });
      assert.ok(await page.locator(".drawing svg").first().isVisible());
      assert.equal(await page.locator("button.theme").isVisible(), false);
      await page.locator("figure details.data > summary").first().click();
      assert.ok(await page.locator("figure details.data table").first().isVisible());
      await context.close();
    });

    test("no figure is broken across printed pages", async () => {
      const { context, page } = await open(file);
      // A mark at the upper and at the lower end of each figure, to find it in the printed pages.
      const count = await page.evaluate(() => {
        // On paper, one of several views appears, and all of a full report.
        const figures = [...document.querySelectorAll("figure.figure")].filter((figure) => !figure.hidden || "paper" in figure.dataset);
        figures.forEach((figure, k) => {
          const mark = (word) => { const p = document.createElement("div"); p.textContent = word; p.style.cssText = "font-size:6px;line-height:6px"; return p; };
          figure.prepend(mark(`upper${k}end`));
          figure.querySelector("figcaption").after(mark(`lower${k}end`));
        });
        return figures.length;
      });
      const bytes = await page.pdf({ preferCSSPageSize: true, printBackground: true });
      await context.close();
      const pdf = await getDocument({ data: new Uint8Array(bytes), verbosity: 0 }).promise;
      const found = new Map();
      for (let k = 1; k <= pdf.numPages; k += 1) {
        const words = (await (await pdf.getPage(k)).getTextContent()).items.map((item) => item.str).join("");
        for (const [mark] of words.matchAll(/(upper|lower)\d+end/g)) found.set(mark, k);
      }
      for (let k = 0; k < count; k += 1) {
        assert.ok(found.has(`upper${k}end`), `figure ${k + 1} is not printed`);
        assert.equal(found.get(`upper${k}end`), found.get(`lower${k}end`), `figure ${k + 1} is broken`);
      }
    });

    test("printed pages are full, and the body is short", async () => {
      const { context, page } = await open(file);
      // Marks at the beginning of each section and at the end of the first one, to find them in the printed pages.
      await page.evaluate(() => {
        const mark = (word) => { const p = document.createElement("div"); p.textContent = word; p.style.cssText = "font-size:2px;line-height:2px"; return p; };
        [...document.querySelectorAll("main > section")].forEach((section, k) => {
          section.before(mark(`section${k}begins`));
          if (k === 0) section.append(mark("page1ends"));
        });
      });
      const bytes = await page.pdf({ preferCSSPageSize: true, printBackground: true });
      await context.close();
      const pdf = await getDocument({ data: new Uint8Array(bytes), verbosity: 0 }).promise;
      const [top, bottom] = [17, 15].map((mm) => mm / 25.4 * 72);
      const pages = [];
      for (let k = 1; k <= pdf.numPages; k += 1) {
        const of = await pdf.getPage(k);
        const high = of.getViewport({ scale: 1 }).height;
        const items = (await of.getTextContent()).items.filter((item) => item.str.trim() && item.transform[5] > bottom && item.transform[5] < high - top);
        const lowest = Math.min(...items.map((item) => item.transform[5]));
        const words = items.map((item) => item.str).join("");
        pages.push({ words, blank: (lowest - bottom) / (high - top - bottom), begins: /^section\d+begins/.test(words) });
      }
      const empty = pages.map((own, k) => [k + 1, own.blank.toFixed(2)]).filter(([k, blank]) => blank > 1 / 3 && k < pages.length && !pages[k].begins);
      // Asserted for the example only: in other runs a figure may be missing to fill a page, and tall figures of a full report have pages of their own.
      if (/example/.test(basename(file))) assert.deepEqual(empty, [], "pages with more than a third blank");
      assert.ok(pages[0].words.includes("page1ends") || /full|levers|offset|pump/.test(basename(file)), "the answer is one page");
      if (!/full/.test(basename(file))) assert.ok(pages.length <= 12, `${pages.length} pages`);
    });

    test("axe-core finds nothing serious", async () => {
      for (const colorScheme of ["light", "dark"]) {
        const { context, page } = await open(file, { colorScheme });
        await page.evaluate(axe);
        const violations = await page.evaluate(async () => (await globalThis.axe.run(document, { resultTypes: ["violations"] })).violations
          .filter((v) => ["serious", "critical"].includes(v.impact)).map((v) => `${v.id}: ${v.nodes.length} x ${v.nodes[0].html.slice(0, 120)}`));
        assert.deepEqual(violations, [], colorScheme);
        await context.close();
      }
    });
  });
}

// Checks a page at any of the widths for cut words and clipped tables; reports the places.
async function cutAtAnyWidth(file) {
  for (const [viewport, media] of [[{ width: 1400, height: 900 }, "screen"], [{ width: 1200, height: 900 }, "screen"], [{ width: 390, height: 844 }, "screen"], [paper, "print"]]) {
    const { context, page, heard } = await open(file, { viewport });
    await page.emulateMedia({ media });
    assert.deepEqual(await page.evaluate(cutWords), [], `${media} ${viewport.width}`);
    const over = await page.evaluate(() => document.documentElement.scrollWidth - document.documentElement.clientWidth);
    assert.ok(over <= 0, `${over} px too wide at ${media} ${viewport.width}`);
    assert.deepEqual(heard.console, []);
    await context.close();
  }
}

for (const file of pages) test(`${basename(file)}: no word is cut`, () => cutAtAnyWidth(file));

for (const folder of folders) {
  test(`${basename(folder)}: no text of a picture lies on another or outside`, async () => {
    const { context, page } = await open(reports[0]);
    for (const name of readdirSync(folder).filter((name) => name.endsWith(".svg"))) {
      const svg = readFileSync(`${folder}/${name}`, "utf8");
      await page.setContent(`<!DOCTYPE html><body style="margin:0"><figure class="figure" id="${name}"><div class="drawing">${svg}</div></figure></body>`);
      assert.deepEqual(await page.evaluate(badTexts), []);
      await page.addStyleTag({ content: 'svg text { font-family: "DejaVu Sans" }' });
      assert.deepEqual(await page.evaluate(badTexts), [], "in a wide face");
      assert.ok(await page.evaluate(() => document.querySelector("svg").width.baseVal.value <= 880), `${name} is too wide for A4`);
    }
    await context.close();
  });
}
