/** Makes the pictures of the README. */

import { SAMPLES, choose, start } from "./browser.js";

const at = (name) => new URL(`../${name}`, import.meta.url).pathname;
const chrome = await start();

const desk = await chrome.open({ viewport: { width: 1200, height: 760 }, colorScheme: "light" });
await choose(desk, `${SAMPLES}kettle.png`);
await desk.click("#edit");
await desk.click("#next-junction");
await desk.screenshot({ path: at("picture.png") });

const phone = await chrome.open({ viewport: { width: 390, height: 780 }, isMobile: true, hasTouch: true, colorScheme: "dark" });
await choose(phone, `${SAMPLES}plan.png`);
await phone.selectOption("#coloring", "pen");
await phone.evaluate(() => scrollTo(0, 0));
await phone.waitForTimeout(300);
await phone.screenshot({ path: at("phone.png") });

await chrome.end();
