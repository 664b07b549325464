/** The page without a mouse: keys, screen readers, touch, dark mode, phones. */

import assert from "node:assert/strict";
import { after, afterEach, before, test } from "node:test";
import { AxeBuilder } from "@axe-core/playwright";
import { SAMPLES, changed, choose, graphOf, onScreen, settle, start, text } from "./browser.js";
import { nodeAt } from "../page/edits.js";

const PHONE = { viewport: { width: 390, height: 844 }, deviceScaleFactor: 2, isMobile: true, hasTouch: true };

let chrome;
let page;
before(async () => (chrome = await start()));
after(() => chrome.end());
afterEach(async () => {
    await page.context().close();
    assert.deepEqual(chrome.errors.splice(0), []);
});

/** Fails where axe finds anything at all. */
async function assertAccessible() {
    const { violations, passes } = await new AxeBuilder({ page }).analyze();
    const found = violations.flatMap(({ id, nodes }) => nodes.map(({ target, failureSummary }) => `${id} ${target}: ${failureSummary}`));
    assert.deepEqual(found, []);
    assert.ok(passes.length > 20);
}

for (const [name, options] of Object.entries({
    light: { colorScheme: "light" },
    dark: { colorScheme: "dark" },
    phone: PHONE,
    "dark phone": { ...PHONE, colorScheme: "dark" },
})) {
    test(`axe finds nothing: ${name}`, async () => {
        page = await chrome.open(options);
        await assertAccessible();
        await choose(page, `${SAMPLES}boat.png`);
        await page.selectOption("#coloring", "pen");
        await page.click("#edit");
        await page.click("#next-junction");
        await page.click("summary");
        await page.click("#pick-only");
        await assertAccessible();
        await page.setInputFiles("#choose", { name: "broken.png", mimeType: "image/png", buffer: Buffer.from("no") });
        await page.waitForSelector("#error:not(:empty)");
        await assertAccessible();
    });
}

test("all of it by keys, told as it happens", async () => {
    page = await chrome.open();
    const focused = () => page.evaluate(() => document.activeElement.id || document.activeElement.textContent);
    const tab = async (id) => {
        for (let i = 0; i < 60 && (await focused()) !== id; i += 1) await page.keyboard.press("Tab");
        assert.equal(await focused(), id);
    };
    await tab("Boat");
    await page.keyboard.press("Enter");
    await settle(page);
    assert.match(await text(page, "#status"), /^boat.png: 20 strokes/);
    const graph = await graphOf(page);
    await page.evaluate(() => document.activeElement.blur());
    await tab("strokes");
    await page.keyboard.press("ArrowRight");
    assert.match(await text(page, "#status"), /^Stroke 1 of 20, \d+ px long/);
    await page.keyboard.press("ArrowLeft");
    assert.match(await text(page, "#status"), /^Stroke 20 of 20/);
    await page.keyboard.press("ArrowRight");
    const fewer = await changed(page, () => page.locator("#strokes").press("Delete"));
    assert.equal(fewer.strokes.length, 19);
    assert.match(await text(page, "#status"), /Stroke deleted, 19 left/);
    await page.locator("#strokes").press("Escape");
    await page.keyboard.press("ArrowRight");
    const joined = await changed(page, () => page.locator("#strokes").press("j"));
    assert.ok(joined.strokes.length === 18 || joined.strokes.some(({ closed }, i) => closed !== fewer.strokes[i].closed));
    await page.locator("#strokes").press("ArrowDown");
    assert.match(await text(page, "#status"), /^Junction 1 of \d, \d+ % sure, \d+ ways/);
    const switched = await changed(page, () => page.locator("#strokes").press("s"));
    assert.notDeepEqual(switched.strokes, joined.strokes);
    for (let i = 0; i < 3; i += 1) await changed(page, () => page.locator("#strokes").press("Control+z"));
    assert.deepEqual((await graphOf(page)).strokes, graph.strokes);
    const [before] = [await onScreen(page, [0, 0])];
    await page.locator("#strokes").press("Shift+ArrowRight");
    assert.ok((await onScreen(page, [0, 0]))[0] < before[0]);
    await page.keyboard.press("+");
    const near = (await onScreen(page, [100, 0]))[0] - (await onScreen(page, [0, 0]))[0];
    await page.keyboard.press("-");
    assert.ok((await onScreen(page, [100, 0]))[0] - (await onScreen(page, [0, 0]))[0] < near);
});

test("keys in a field stay in the field", async () => {
    page = await chrome.open();
    await choose(page, `${SAMPLES}kettle.png`);
    await page.click("#next");
    await changed(page, () => page.click("#delete"));
    await page.locator("[name=millimetres]").fill("70");
    await page.locator("[name=millimetres]").press("Control+z");
    await page.locator("[name=millimetres]").press("Delete");
    assert.equal((await graphOf(page)).strokes.length, 10);
});

test("a picked colour is let go with Escape", async () => {
    page = await chrome.open();
    await choose(page, `${SAMPLES}kettle.png`);
    await page.click("#pick-only");
    await page.locator("#strokes").press("Escape");
    assert.equal(await page.isVisible("#pick-help"), false);
});

test("on a phone: a tap edits, two fingers zoom, one finger moves", async () => {
    page = await chrome.open(PHONE);
    await page.tap("#gallery button:has-text('Kettle')");
    await settle(page);
    const graph = await graphOf(page);
    assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), "nothing is wider than the screen");
    await page.tap("#edit");
    const steam = nodeAt(graph, { stroke: 10, atEnd: true });
    const toTop = () => page.evaluate(() => scrollTo(0, 0));
    const fewer = await changed(page, async () => {
        await toTop();
        await page.touchscreen.tap(...(await onScreen(page, [steam.x, steam.y - 15])));
    });
    assert.equal(fewer.strokes.length, 10);

    await toTop();
    const session = await page.context().newCDPSession(page);
    const touch = (type, ...places) =>
        session.send("Input.dispatchTouchEvent", { type, touchPoints: places.map(([x, y], id) => ({ x, y, id })) });
    const scale = async () => (await onScreen(page, [100, 0]))[0] - (await onScreen(page, [0, 0]))[0];
    const before = await scale();
    await touch("touchStart", [150, 300], [250, 300]);
    for (let i = 1; i <= 10; i += 1) await touch("touchMove", [150 - 10 * i, 300], [250 + 10 * i, 300]);
    await touch("touchEnd");
    assert.ok(Math.abs((await scale()) / before - 3) < 0.1, `${(await scale()) / before}`);
    const [left] = await onScreen(page, [0, 0]);
    await touch("touchStart", [300, 200]);
    for (let i = 1; i <= 5; i += 1) await touch("touchMove", [300 - 10 * i, 200]);
    await touch("touchEnd");
    assert.ok(Math.abs((await onScreen(page, [0, 0]))[0] - left + 50) < 2);
    assert.equal((await graphOf(page)).strokes.length, 10);
});
