// Loads each page in windows of some widths and on paper, looks at it and uses its movie.
const faults = [];
const pause = (time) => new Promise((done) => setTimeout(done, time));
const PAPER = 718; // A4 between its margins
const LEAST_CONTRAST = 4.5;

// What print would show: its rules apply, and those of screens do not.
const turnToPaper = (page) => {
  for (const sheet of page.document.styleSheets) {
    for (const rule of [...sheet.cssRules].filter((rule) => rule.media)) {
      rule.media.mediaText = rule.media.mediaText === "print" ? "all" : "not all";
    }
  }
};

const isSeen = (box) => box.width > 0 && box.height > 0;

// Labels of a picture lie inside of it, and none on another.
const lookAtPicture = (svg, fault) => {
  const whole = svg.getBoundingClientRect();
  if (!isSeen(whole)) return;
  const labels = [...svg.querySelectorAll("text")].filter((text) => text.textContent.trim());
  const boxes = labels.map((text) => text.getBoundingClientRect());
  const name = svg.querySelector("title")?.textContent ?? "a picture";
  boxes.forEach((box, k) => {
    const out = Math.max(whole.left - box.left, box.right - whole.right, whole.top - box.top, box.bottom - whole.bottom);
    if (out > 2) fault(`${name}: “${labels[k].textContent}” ends ${out.toFixed(1)} px outside`);
    for (let other = 0; other < k; other++) {
      const by = boxes[other];
      const across = Math.min(box.right, by.right) - Math.max(box.left, by.left);
      const down = Math.min(box.bottom, by.bottom) - Math.max(box.top, by.top);
      // A box is higher than its letters.
      if (across > 1 && down > 0.4 * Math.min(box.height, by.height)) {
        fault(`${name}: “${labels[k].textContent}” lies on “${labels[other].textContent}”`);
      }
    }
  });
  for (const bar of svg.querySelectorAll("rect")) {
    const box = bar.getBoundingClientRect();
    if (isSeen(box) && Math.min(box.width, box.height) < 0.5) fault(`${name}: a bar of ${box.width.toFixed(2)} by ${box.height.toFixed(2)} px`);
  }
};

const luminance = (colour) => {
  const parts = colour.match(/[\d.]+/g).slice(0, 3).map((part) => part / 255);
  const [r, g, b] = parts.map((part) => (part <= 0.04045 ? part / 12.92 : ((part + 0.055) / 1.055) ** 2.4));
  return 0.2126 * r + 0.7152 * g + 0.0722 * b;
};

// Words stand out from what is behind them, and stay in their boxes.
const lookAtWords = (page, fault) => {
  for (const element of page.document.body.querySelectorAll("*")) {
    const own = [...element.childNodes].some((node) => node.nodeType === 3 && node.textContent.trim());
    if (!own || element.closest("svg, script, style") || !isSeen(element.getBoundingClientRect())) continue;
    let behind = element;
    while (behind && /^rgba\(.*, 0\)$/.test(page.getComputedStyle(behind).backgroundColor)) behind = behind.parentElement;
    const [ink, paper] = [page.getComputedStyle(element).color, behind ? page.getComputedStyle(behind).backgroundColor : "rgb(255, 255, 255)"].map(luminance);
    const contrast = (Math.max(ink, paper) + 0.05) / (Math.min(ink, paper) + 0.05);
    const words = `“${element.textContent.trim().slice(0, 40)}”`;
    if (contrast < LEAST_CONTRAST) fault(`${words} has a contrast of ${contrast.toFixed(1)}`);
    if (element.scrollWidth > element.clientWidth + 1 && page.getComputedStyle(element).display !== "inline" && !element.closest(".scroll")) {
      fault(`${words} is wider than its box`);
    }
  }
};

// Each figure can be kept, with the numbers in it.
const keepFigures = async (page, fault) => {
  for (const figure of page.document.querySelectorAll("figure")) {
    const table = figure.querySelector("svg > metadata");
    const wanted = ["SVG", ...(table ? ["CSV"] : []), ...(figure.querySelector("canvas") ? ["PNG"] : [])];
    const links = [...figure.querySelectorAll(".keep a")], name = figure.querySelector("title")?.textContent;
    if (links.map((link) => link.textContent).join() !== wanted.join()) fault(`${name}: is kept as ${links.map((link) => link.textContent)}`);
    for (const link of links.slice(0, 2)) {
      link.addEventListener("click", (event) => event.preventDefault());
      link.click();
      const text = await (await page.fetch(link.href)).text();
      const begins = { SVG: "<svg xmlns=", CSV: "series,", PNG: "" }[link.textContent];
      if (!text.startsWith(begins)) fault(`${name}: its ${link.textContent} begins with “${text.slice(0, 20)}”`);
    }
  }
};

const use = async (page, fault) => {
  const figure = page.document.querySelector("figure.player");
  if (!figure) return;
  const part = (name) => figure.querySelector(`[data-part="${name}"]`);
  const shown = () => Number(figure.dataset.frame);
  const expect = (sound, what) => sound || fault(what);
  const key = (name) => part("canvas").dispatchEvent(new page.KeyboardEvent("keydown", { key: name, bubbles: true, cancelable: true }));
  expect(!part("live").hidden && page.getComputedStyle(figure.querySelector(".still")).display === "none", "the player does not replace the still");
  if (part("play")) {
    const last = Number(part("slider").max);
    key("Home");
    expect(shown() === 0, "Home does not go to the first frame");
    part("forward").click();
    key("ArrowRight");
    expect(shown() === 2, "steps do not step");
    part("back").click();
    key("ArrowLeft");
    expect(shown() === 0, "steps back do not step back");
    key("End");
    expect(shown() === last, "End does not go to the last frame");
    part("slider").value = 1;
    part("slider").dispatchEvent(new page.Event("input"));
    expect(shown() === 1, "the slider does not move the movie");
    part("speed").value = 30;
    part("play").click();
    expect(part("play").textContent === "Pause", "the button does not say that it plays");
    for (let turn = 0; turn < 100 && shown() === 1; turn++) await pause(20);
    expect(shown() !== 1, "nothing plays");
    key(" ");
    expect(part("play").textContent === "Play", "the space bar does not pause");
  }
  const canvas = part("canvas"), box = canvas.getBoundingClientRect();
  // Clicks have whole coordinates.
  const [clientX, clientY] = [box.left + 0.5 * box.width, box.top + 0.4 * box.height].map(Math.round);
  const point = (kind) => canvas.dispatchEvent(new page.PointerEvent(kind, { clientX, clientY, bubbles: true, pointerType: "mouse" }));
  point("pointermove");
  const told = part("reading").textContent;
  expect(/cell \d+.*: .*area [\d.]+ AREA/.test(told), `pointing at a cell tells “${told}”`);
  point("click");
  point("pointerleave");
  expect(part("reading").textContent.startsWith(told.split(/[:,]/)[0]), `${told} is not followed: ${part("reading").textContent}`);
  key("Escape");
  expect(part("reading").textContent === part("reading").dataset.hint, "Escape does not let go of a cell");
  const picture = () => canvas.toDataURL();
  for (const name of ["colour", "arrows"]) {
    const pictures = new Set([...part(name).options].map((option) => {
      part(name).value = option.value;
      part(name).dispatchEvent(new page.Event("change"));
      return picture();
    }));
    expect(pictures.size === part(name).options.length, `${name} does not change the picture`);
  }
  for (const name of ["outlines", "marks", "borders"]) {
    const before = picture();
    if (part(name)) part(name).click();
    expect(!part(name) || picture() !== before, `${name} cannot be hidden`);
  }
  expect(canvas.getBoundingClientRect().right <= page.innerWidth, "the picture is wider than the window");
};

const look = async (name, width, onPaper) => {
  const frame = document.createElement("iframe");
  frame.style.cssText = `width: ${width}px; height: 900px; border: 0`;
  const loaded = new Promise((done) => (frame.onload = done));
  frame.src = name;
  document.body.append(frame);
  await loaded;
  await pause(50);
  const page = frame.contentWindow, fault = (what) => faults.push(`${name} ${onPaper ? "on paper" : `at ${width}`}: ${what}`);
  if (onPaper) turnToPaper(page);
  const wide = page.document.documentElement.scrollWidth;
  if (page.innerWidth !== width) fault(`the window is ${page.innerWidth} wide`);
  if (wide > page.innerWidth) fault(`the page is ${wide} wide`);
  page.document.querySelectorAll("svg").forEach((svg) => lookAtPicture(svg, fault));
  lookAtWords(page, fault);
  try {
    if (!onPaper) await use(page, fault);
    if (!onPaper && width === WIDTHS[0]) await keepFigures(page, fault);
  } catch (error) {
    fault(String(error));
  }
  page.faults.forEach(fault);
  frame.remove();
};

(async () => {
  let windows = 0;
  for (const name of PAGES) {
    for (const [width, onPaper] of [...WIDTHS.map((width) => [width, false]), [PAPER, true]]) {
      await look(name, width, onPaper);
      windows += 1;
    }
  }
  const told = document.createElement("pre");
  told.id = "faults";
  told.textContent = faults.length ? faults.join("\n") : `${windows} windows, none with a fault`;
  document.body.append(told);
})();
