// Writes page 1 of a report, as printed, into a PNG file: node picture.mjs REPORT.html PICTURE.png, with CHROMIUM=/path/to/chromium.
import { createServer } from "node:http";
import { readFileSync, writeFileSync } from "node:fs";
import { resolve } from "node:path";
import { pathToFileURL } from "node:url";
import { chromium } from "playwright-core";

const [report, picture] = process.argv.slice(2);
const WIDTH = 900;
const library = new URL("node_modules/pdfjs-dist/build/", import.meta.url);

const browser = await chromium.launch({ executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium", args: ["--no-sandbox", "--disable-gpu"] });
const page = await browser.newPage();
await page.goto(pathToFileURL(resolve(report)).href);
const pdf = await page.pdf({ preferCSSPageSize: true, printBackground: true, pageRanges: "1" });

// pdf.js draws the page in the browser. Modules cannot be loaded from files, so a local server provides them.
const server = createServer((request, response) => {
  const name = request.url.slice(1);
  if (name === "") return response.setHeader("content-type", "text/html").end("<canvas></canvas>");
  if (name === "page.pdf") return response.end(pdf);
  if (!/^pdf(\.worker)?\.mjs$/.test(name)) return response.writeHead(404).end();
  return response.setHeader("content-type", "text/javascript").end(readFileSync(new URL(name, library)));
});
await new Promise((listening) => server.listen(0, "127.0.0.1", listening));
await page.goto(`http://127.0.0.1:${server.address().port}/`);
const png = await page.evaluate(async (width) => {
  const { getDocument, GlobalWorkerOptions } = await import("/pdf.mjs");
  GlobalWorkerOptions.workerSrc = "/pdf.worker.mjs";
  const first = await (await getDocument("/page.pdf").promise).getPage(1);
  const viewport = first.getViewport({ scale: width / first.getViewport({ scale: 1 }).width });
  const canvas = document.querySelector("canvas");
  [canvas.width, canvas.height] = [viewport.width, viewport.height];
  await first.render({ canvas, viewport }).promise;
  return canvas.toDataURL("image/png");
}, WIDTH);
writeFileSync(picture, Buffer.from(png.split(",")[1], "base64"));
await browser.close();
server.close();
