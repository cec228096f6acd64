// The book in a real browser. Usage: node --test book.test.mjs, with BOOK=/path/to/docs/book/book and CHROMIUM=/path/to/chromium.
// Truth: the browser: requests sent, boxes laid out, colours painted, search results.
import assert from "node:assert/strict";
import { mkdirSync, readdirSync } from "node:fs";
import { basename, resolve } from "node:path";
import { pathToFileURL } from "node:url";
import { after, before, test } from "node:test";
import { chromium } from "playwright-core";

const book = resolve(process.env.BOOK ?? "../../docs/book/book");
const shots = process.env.SHOTS;
const home = pathToFileURL(`${book}/`).href;
// print.html has all pages in one, toc.html the list of pages that others show in a frame.
const pages = readdirSync(book).filter((name) => name.endsWith(".html") && !["print.html", "toc.html", "404.html"].includes(name));
const switches = ["--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync"];
const desktop = { viewport: { width: 1280, height: 900 } };
const phone = { viewport: { width: 390, height: 844 }, isMobile: true };

assert.ok(pages.length > 40, `${book} holds ${pages.length} pages`);
let browser;
before(async () => { browser = await chromium.launch({ executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium", args: switches }); });
after(async () => { await browser?.close(); });

// Opens a page in a theme; returns console messages and requests.
async function open(options, theme) {
  const context = await browser.newContext(options);
  await context.addInitScript((name) => localStorage.setItem("mdbook-theme", name), theme);
  const page = await context.newPage();
  const heard = [];
  page.on("console", (message) => { if (["error", "warning"].includes(message.type())) heard.push(message.text()); });
  page.on("pageerror", (error) => heard.push(String(error)));
  page.on("request", (request) => { if (!/^(data|blob):/.test(request.url()) && !request.url().startsWith(home)) heard.push(`requests ${request.url()}`); });
  const visit = (name) => page.goto(home + name);
  const shot = async (name) => {
    if (!shots) return;
    mkdirSync(shots, { recursive: true });
    await page.screenshot({ path: `${shots}/${basename(name, ".html")}_${theme}_${options.viewport.width}.png`, fullPage: true });
  };
  return { context, page, heard, visit, shot };
}

// Defects of the drawings of a page: overlapping or outlying texts, texts too small to read, light backgrounds and dark texts in dark themes.
const faults = (dark) => {
  const found = [];
  const light = (colour) => colour.match(/[\d.]+/g).slice(0, 3).reduce((sum, x) => sum + Number(x), 0);
  for (const figure of document.querySelectorAll("main figure")) {
    const svg = figure.querySelector("svg");
    const name = svg.querySelector("title").textContent;
    const frame = svg.getBoundingClientRect();
    const boxes = [...svg.querySelectorAll("text")].filter((text) => text.textContent.trim()).map((text) => {
      const box = text.getBoundingClientRect();
      // The box has the line height of the font, with empty space above and below the letters.
      const air = box.height > box.width ? [box.width * 0.2, 0.5] : [0.5, box.height * 0.24];
      return { text, words: text.textContent, left: box.left + air[0], right: box.right - air[0], top: box.top + air[1], bottom: box.bottom - air[1] };
    });
    for (const [k, one] of boxes.entries()) {
      if (one.left < frame.left - 1 || one.right > frame.right + 1 || one.top < frame.top - 1 || one.bottom > frame.bottom + 1) found.push(`${name}: "${one.words}" leaves the drawing`);
      for (const other of boxes.slice(k + 1)) {
        const wide = Math.min(one.right, other.right) - Math.max(one.left, other.left);
        const tall = Math.min(one.bottom, other.bottom) - Math.max(one.top, other.top);
        if (wide > 0.5 && tall > 0.5) found.push(`${name}: "${one.words}" on "${other.words}"`);
      }
      const size = parseFloat(getComputedStyle(one.text).fontSize) * frame.width / svg.viewBox.baseVal.width;
      if (size < 8) found.push(`${name}: "${one.words}" is ${size.toFixed(1)} px high`);
      const ink = light(getComputedStyle(one.text).fill);
      if (dark ? ink < 330 : ink > 480) found.push(`${name}: "${one.words}" is painted ${getComputedStyle(one.text).fill}`);
    }
    for (const shape of dark ? svg.querySelectorAll("rect, path, circle") : []) {
      const box = shape.getBoundingClientRect();
      const fill = getComputedStyle(shape).fill;
      if (box.width * box.height > 900 && fill.startsWith("rgb(") && light(fill) > 560) found.push(`${name}: a ${shape.tagName} is painted ${fill}`);
    }
  }
  if (dark) for (const image of document.querySelectorAll("main img")) found.push(`${image.src} does not follow the theme`);
  return found;
};

for (const [name, options, theme] of [["a desktop", desktop, "light"], ["a desktop at night", desktop, "navy"], ["a phone", phone, "light"], ["a phone at night", phone, "coal"]]) {
  test(`every page on ${name}: nothing said, nothing loaded from elsewhere, nothing too wide, drawings readable`, async () => {
    const { context, page, heard, visit, shot } = await open(options, theme);
    const bad = [];
    for (const file of pages) {
      await visit(file);
      const over = await page.evaluate(() => document.documentElement.scrollWidth - document.documentElement.clientWidth);
      if (over > 0) bad.push(`${file} is ${over} px too wide`);
      bad.push(...(await page.evaluate(faults, theme !== "light")).map((fault) => `${file}: ${fault}`));
      bad.push(...heard.splice(0).map((word) => `${file}: ${word}`));
      await shot(file);
    }
    assert.deepEqual(bad, []);
    await context.close();
  });
}

test("the search finds a page by its words", async () => {
  const { context, page, heard, visit } = await open(desktop, "light");
  await visit("introduction.html");
  await page.locator("#mdbook-search-toggle").click();
  await page.locator("#mdbook-searchbar").pressSequentially("torque converter lock-up");
  const results = page.locator("#mdbook-searchresults a");
  await results.first().waitFor({ timeout: 10_000 });
  const targets = await results.evaluateAll((links) => links.map((link) => link.getAttribute("href")));
  assert.ok(targets.some((target) => target.includes("torque_converter.html")), targets.join("\n"));
  assert.deepEqual(heard, []);
  await context.close();
});

test("the rows of the validation fold by chapter", async () => {
  const { context, page, visit } = await open(phone, "light");
  await visit("validation.html");
  const groups = page.locator("main details");
  assert.ok(await groups.count() > 8, "groups by chapter");
  const height = await page.evaluate(() => document.documentElement.scrollHeight);
  assert.ok(height < 6000, `closed, the page is ${height} px long`);
  await groups.first().locator("summary").click();
  assert.ok(await groups.first().locator("table").isVisible());
  await context.close();
});
