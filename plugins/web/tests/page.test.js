/** Files in and out of the page, in Chromium. */

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, afterEach, before, test } from "node:test";
import { LONG, SAMPLES, choose, download, graphOf, longestTask, painted, picture, settle, start, svgOf, text, until } from "./browser.js";
import { difference, elements } from "./svg.js";

const KETTLE = `${SAMPLES}kettle.png`;
const native = (path) => execFileSync(process.env.TRACE, [path, "-o", "-", "--format", "svg"]).toString();

let chrome;
let page;
before(async () => (chrome = await start()));
after(() => chrome.end());
afterEach(async () => {
    await page.context().close();
    // The page asks for nothing elsewhere and throws nothing, whatever is done with it.
    assert.deepEqual(chrome.errors.splice(0), []);
});

test("the page can be used at once", async () => {
    page = await chrome.open();
    const [ready, shown] = await page.evaluate(() => [
        performance.getEntriesByType("navigation")[0].domContentLoadedEventEnd,
        performance.getEntriesByName("first-contentful-paint")[0].startTime,
    ]);
    console.log(`page: shown after ${shown.toFixed(0)} ms, usable after ${ready.toFixed(0)} ms`);
    assert.match(await text(page, "header"), /Nothing is uploaded/);
    // The engine is loaded with the first drawing, and by the service worker.
    const own = await page.evaluate(() => performance.getEntriesByType("resource").map(({ name }) => name));
    assert.ok(own.length > 10 && !own.some((name) => name.endsWith(".wasm")));
});

test("a chosen file gives the strokes that the command gives", async () => {
    page = await chrome.open();
    for (const name of ["kettle.png", "leaf.jpg"]) {
        await choose(page, SAMPLES + name);
        const svg = await svgOf(page);
        assert.match(await text(page, "#status"), new RegExp(`${elements(svg).length} strokes`));
        // Two decimals, which may be rounded either way.
        assert.ok(difference(svg, native(SAMPLES + name)) <= 0.021);
    }
});

test("a pasted picture is traced", async () => {
    page = await chrome.open({ permissions: ["clipboard-read", "clipboard-write"] });
    await page.evaluate(async () => {
        const image = (await fetch("samples/kettle.png")).blob();
        await navigator.clipboard.write([new ClipboardItem({ "image/png": image })]);
    });
    await page.keyboard.press("Control+V");
    await settle(page);
    assert.ok(difference(await svgOf(page), native(KETTLE)) <= 0.021);
});

test("a dropped file is traced, one from the gallery, and one that the library does not know but the browser", async () => {
    page = await chrome.open();
    const data = await page.evaluateHandle(async () => {
        const data = new DataTransfer();
        data.items.add(new File([await (await fetch("samples/kettle.png")).blob()], "dropped.png"));
        return data;
    });
    await page.dispatchEvent("#stage", "drop", { dataTransfer: data });
    await settle(page);
    assert.match(await text(page, "#status"), /^dropped.png: 11 strokes/);
    await page.click("#gallery button:has-text('Plan')");
    await page.waitForFunction(() => document.querySelector("#status").textContent.startsWith("plan.png: 27"), null, { timeout: LONG });
    const webp = await picture(page, { name: "a.webp", width: 320, height: 300, sample: "samples/kettle.png" }, (context, sample) =>
        context.drawImage(sample, 0, 0),
    );
    await choose(page, webp);
    assert.ok((await graphOf(page)).strokes.length >= 10);
});

test("the camera is asked for where a photo is to be taken", async () => {
    page = await chrome.open();
    assert.equal(await page.getAttribute("#photograph", "capture"), "environment");
    await page.setInputFiles("#photograph", KETTLE);
    await settle(page);
    assert.match(await text(page, "#status"), /11 strokes/);
});

test("files of each format, with the size in millimetres", async () => {
    page = await chrome.open();
    await choose(page, KETTLE);
    assert.match(await svgOf(page), /viewBox="0 0 320 300" width="320"/);
    await page.fill("[name=millimetres]", "80");
    await page.waitForFunction(() => document.querySelector("output[for=millimetres]").value === "80.0 × 75.0 mm at 102 dpi");
    await until(page, svgOf, (svg) => svg.includes('viewBox="0 0 80 75"'));
    const svg = await download(page, "svg");
    assert.equal(svg.name, "kettle.svg");
    assert.match(svg.bytes.toString(), /height="75mm".*width="80mm"/);
    const dxf = (await download(page, "dxf")).bytes.toString();
    assert.match(dxf, /\$INSUNITS\s+70\s+4\s/);
    const pdf = (await download(page, "pdf")).bytes.toString("latin1");
    assert.match(pdf, /^%PDF-/);
    const [width, height] = pdf.match(/MediaBox ?\[ ?0 0 ([\d.]+) ([\d.]+)/).slice(1).map(Number);
    assert.ok(Math.abs(width - (80 / 25.4) * 72) < 0.1 && Math.abs(height - (75 / 25.4) * 72) < 0.1);
    assert.ok(Math.abs((await graphOf(page)).dpi - 101.6) < 1e-6);
});

test("a broken file is told of, and the drawing before stays", async () => {
    page = await chrome.open();
    const broken = { name: "broken.png", mimeType: "image/png", buffer: readFileSync(KETTLE).subarray(0, 900) };
    const notes = { name: "notes.txt", mimeType: "text/plain", buffer: Buffer.from("no drawing") };
    for (const file of [broken, notes]) {
        await page.setInputFiles("#choose", file);
        await page.waitForFunction((name) => document.querySelector("#error").textContent.includes(name), file.name);
        assert.equal(await text(page, "#status"), "No drawing yet.");
    }
    await choose(page, KETTLE);
    assert.equal(await text(page, "#error"), "");
    await page.setInputFiles("#choose", broken);
    await page.waitForFunction(() => document.querySelector("#error").textContent.includes("broken.png"));
    await settle(page);
    assert.equal((await graphOf(page)).strokes.length, 11);
});

/** A photo of 20 megapixels as a file in a folder: leaves side by side. */
async function photo(page, folder) {
    const size = { name: "photo.jpg", width: 5472, height: 3648, sample: "samples/leaf.jpg" };
    const { buffer } = await picture(page, size, (context, sample) => {
        for (let y = 0; y < 3648; y += 912) for (let x = 0; x < 5472; x += 912) context.drawImage(sample, x, y, 912, 912);
    });
    const path = join(folder, "photo.jpg");
    writeFileSync(path, buffer);
    return path;
}

test("a photo of 20 megapixels is stopped, then traced, and the page never freezes", async (t) => {
    page = await chrome.open();
    const folder = mkdtempSync(join(tmpdir(), "fieldtrace-"));
    t.after(() => rmSync(folder, { recursive: true }));
    const file = await photo(page, folder);
    await page.setInputFiles("#choose", file);
    await page.waitForFunction(() => /directions/.test(document.querySelector("#status").textContent), null, { timeout: LONG });
    const asked = performance.now();
    await page.click("#cancel");
    await page.waitForFunction(() => document.querySelector("#progress").hidden);
    console.log(`stopped after ${(performance.now() - asked).toFixed(0)} ms`);
    assert.equal(await page.isVisible("#welcome"), true);

    const began = performance.now();
    let size = null;
    let found = 0;
    const longest = await longestTask(page, async () => {
        await page.setInputFiles("#choose", file);
        await page.waitForSelector("#progress:not([hidden])");
        while (await page.isVisible("#progress")) {
            size ??= await page.locator("#sheet").evaluate((sheet) => sheet.offsetWidth || null);
            await page.click("#zoom-in");
            await page.click("#zoom-fit");
            if (/Following|Fitting/.test(await text(page, "#status"))) found = Math.max(found, (await painted(page)).count);
            await page.waitForTimeout(500);
        }
    });
    await settle(page);
    const seconds = ((performance.now() - began) / 1000).toFixed(1);
    console.log(`20 megapixels: ${await text(page, "#status")} ${seconds} s; longest task of the page: ${longest.toFixed(0)} ms`);
    assert.equal(size, 5472);
    assert.ok(found > 1000, "lines are drawn in as they are found");
    assert.ok((await graphOf(page)).strokes.length > 24 * 10);
    assert.ok(longest < 1000);
});

test("it works when the server is gone, after the first visit", async () => {
    page = await chrome.open();
    await page.waitForSelector("#offline:not([hidden])");
    await page.waitForFunction(() => navigator.serviceWorker.controller !== null);
    await chrome.server.close();
    await page.context().setOffline(true);
    await page.reload();
    await page.click("#gallery button:has-text('Boat')");
    await settle(page);
    assert.match(await text(page, "#status"), /^boat.png: 20 strokes/);
    assert.match((await download(page, "dxf")).bytes.toString(), /EOF/);
});
