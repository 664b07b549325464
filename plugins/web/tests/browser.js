/** The page in Chromium. */

import { readFile } from "node:fs/promises";
import { chromium } from "playwright-core";
import { serve } from "./serve.js";

export const SITE = new URL("../site", import.meta.url).pathname;
export const SAMPLES = new URL("../../../samples/", import.meta.url).pathname;

/** How long a trace may take on a slow machine. */
export const LONG = 120_000;

/** Starts a server and a browser; `open(options)` gives a page on it whose errors are collected, `end()` ends all. */
export async function start() {
    const server = await serve(SITE);
    const executablePath = process.env.CHROMIUM ?? "/usr/bin/chromium";
    const browser = await chromium.launch({ executablePath, args: ["--no-sandbox"] });
    const errors = [];

    async function open(options = {}) {
        const context = await browser.newContext({ viewport: { width: 1280, height: 800 }, ...options });
        const page = await context.newPage();
        page.setDefaultTimeout(30_000);
        page.on("pageerror", (error) => errors.push(error.message));
        page.on("console", (message) => message.type() === "error" && errors.push(message.text()));
        page.on("request", (request) => {
            const isOwn = request.url().startsWith(server.url) || request.url().startsWith("blob:");
            if (!isOwn || request.method() !== "GET") errors.push(`${request.method()} ${request.url()}`);
        });
        await page.goto(server.url);
        return page;
    }

    async function end() {
        await browser.close();
        await server.close();
    }

    return { server, errors, open, end };
}

export const text = (page, selector) => page.locator(selector).innerText();
export const counts = (graph) => [graph.strokes.length, graph.edges.length, graph.nodes.length];

/** Waits until the page has a drawing and nothing runs. */
export async function settle(page) {
    await page.waitForSelector("#downloads button:not(:disabled)", { timeout: LONG });
    await page.waitForSelector("#progress", { state: "hidden", timeout: LONG });
}

/** Gives a picture to the page as a file that was chosen, and waits for its strokes. */
export async function choose(page, file) {
    await page.setInputFiles("#choose", file);
    const name = typeof file === "string" ? file.split("/").at(-1) : file.name;
    await page.waitForFunction((name) => document.querySelector("#status").textContent.startsWith(`${name}: `), name, { timeout: LONG });
    await settle(page);
}

/** The bytes of a download. */
export async function download(page, format) {
    const [file] = await Promise.all([page.waitForEvent("download"), page.click(`[data-format=${format}]`)]);
    return { name: file.suggestedFilename(), bytes: await readFile(await file.path()) };
}

/** The stroke graph, without what the file says of its making. */
export async function graphOf(page) {
    const { origin, ...graph } = JSON.parse((await download(page, "json")).bytes);
    return graph;
}

export const svgOf = async (page) => (await download(page, "svg")).bytes.toString();

/** Waits until what `read` gives of the page is as it should be, and gives it. */
export async function until(page, read, isDone) {
    const end = performance.now() + LONG;
    while (performance.now() < end) {
        await settle(page);
        const now = await read(page);
        if (isDone(now)) return now;
        await page.waitForTimeout(50);
    }
    throw new Error("it does not come to be so");
}

/** Does something that changes what `read` gives, and gives that once it is another. */
async function other(page, read, act) {
    const before = JSON.stringify(await read(page));
    await act();
    return until(page, read, (now) => JSON.stringify(now) !== before);
}

/** Does something that changes the graph, and gives it. */
export const changed = (page, act) => other(page, graphOf, act);

/** Does something that changes the strokes, and gives the SVG. */
export const redrawn = (page, act) => other(page, svgOf, act);

/** Where the picture lies on the screen: the place of its corner, and its scale. */
const frame = (page) =>
    page.locator("#sheet").evaluate((sheet) => {
        const { left, top, width } = sheet.getBoundingClientRect();
        return [left, top, width / sheet.offsetWidth];
    });

/** The place on the screen of a place in the picture. */
export async function onScreen(page, [x, y]) {
    const [left, top, scale] = await frame(page);
    return [left + x * scale, top + y * scale];
}

/** The place in the picture of a place on the screen. */
export async function inPicture(page, [x, y]) {
    const [left, top, scale] = await frame(page);
    return [(x - left) / scale, (y - top) / scale];
}

/** Clicks a place in the picture. */
export const clickAt = async (page, place) => page.mouse.click(...(await onScreen(page, place)));

/** How many pixels of the canvas are painted, and in which colours those that are opaque, as 0xbbggrr. */
export async function painted(page) {
    const counts = await page.locator("#strokes").evaluate((canvas) => {
        const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
        const counts = new Map();
        for (const pixel of new Uint32Array(data.buffer)) if (pixel > 0) counts.set(pixel, (counts.get(pixel) ?? 0) + 1);
        return [...counts];
    });
    const isOpaque = (pixel) => pixel >>> 24 === 255;
    const colors = counts.filter(([pixel, count]) => isOpaque(pixel) && count > 20).map(([pixel]) => pixel & 0xffffff);
    return { count: counts.reduce((sum, [, count]) => sum + count, 0), colors };
}

/** The longest task of the page while something is done, in milliseconds of its own time: other programs may be at work. */
export async function longestTask(page, act) {
    const browser = page.context().browser();
    await browser.startTracing(page, { categories: ["toplevel", "devtools.timeline", "v8"] });
    await act();
    const { traceEvents } = JSON.parse(await browser.stopTracing());
    const isMain = ({ name, args }) => name === "thread_name" && args.name === "CrRendererMain";
    const mains = new Set(traceEvents.filter(isMain).map(({ pid, tid }) => `${pid} ${tid}`));
    const tasks = traceEvents.filter(({ ph, pid, tid, tdur }) => ph === "X" && tdur > 0 && mains.has(`${pid} ${tid}`));
    return tasks.reduce((most, { tdur }) => Math.max(most, tdur), 0) / 1000;
}

/** Paints a picture in the browser, and encodes it. */
async function encoded({ type, width, height, sample }, paint) {
    const canvas = new OffscreenCanvas(width, height);
    const context = canvas.getContext("2d");
    context.fillStyle = "#fff";
    context.fillRect(0, 0, width, height);
    paint(context, sample && (await createImageBitmap(await (await fetch(sample)).blob())));
    const blob = await canvas.convertToBlob({ type, quality: 0.9 });
    return new Uint8Array(await blob.arrayBuffer()).toBase64();
}

/** A picture that a function paints in the browser, as a file. It gets a canvas's context, and a sample where one is named. */
export async function picture(page, { name, ...size }, paint) {
    const type = name.endsWith("jpg") ? "image/jpeg" : "image/png";
    const base64 = await page.evaluate(`(${encoded})(${JSON.stringify({ type, ...size })}, ${paint})`);
    return { name, mimeType: type, buffer: Buffer.from(base64, "base64") };
}
