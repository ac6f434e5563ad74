// Loads each page in windows of three widths, looks at it and uses its movie.
const faults = [];
const pause = (time) => new Promise((done) => setTimeout(done, time));

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
  expect(/cell \d+.*: .*area [\d.]+ µm²/.test(told), `pointing at a cell tells “${told}”`);
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

const look = async (name, width) => {
  const frame = document.createElement("iframe");
  frame.style.cssText = `width: ${width}px; height: 900px; border: 0`;
  const loaded = new Promise((done) => (frame.onload = done));
  frame.src = name;
  document.body.append(frame);
  await loaded;
  await pause(50);
  const page = frame.contentWindow, fault = (what) => faults.push(`${name} at ${width}: ${what}`);
  const wide = page.document.documentElement.scrollWidth;
  if (page.innerWidth !== width) fault(`the window is ${page.innerWidth} wide`);
  if (wide > page.innerWidth) fault(`the page is ${wide} wide`);
  try {
    await use(page, fault);
  } catch (error) {
    fault(String(error));
  }
  page.faults.forEach(fault);
  frame.remove();
};

(async () => {
  let windows = 0;
  for (const name of PAGES) {
    for (const width of WIDTHS) {
      await look(name, width);
      windows += 1;
    }
  }
  const told = document.createElement("pre");
  told.id = "faults";
  told.textContent = faults.length ? faults.join("\n") : `${windows} windows, none with a fault`;
  document.body.append(told);
})();
