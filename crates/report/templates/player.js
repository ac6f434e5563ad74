for (const figure of document.querySelectorAll("figure.player")) {
  const part = (name) => figure.querySelector(`[data-part="${name}"]`);
  const movie = JSON.parse(part("data").textContent);
  const bytes = Uint8Array.from(atob(movie.data), (letter) => letter.charCodeAt(0)).buffer;
  const UNKNOWN = 65535, STEPS = 65534;
  const STATUS = ["", "left out", "not detected", "uncertain"];

  // The numbers of each frame, as written by the program.
  let end = 0;
  const take = (Kind, count) => {
    const start = end;
    end += count * Kind.BYTES_PER_ELEMENT;
    return new Kind(bytes.slice(start, end));
  };
  const value = (step, [low, high]) => (step === UNKNOWN ? NaN : low + (step / STEPS) * (high - low));
  const [low, high] = movie.grid;
  const place = (steps, k) => [0, 1].map((axis) => value(steps[2 * k + axis], [low[axis], high[axis]]));
  const frames = movie.frames.map(({ label, time, cells, corners }) => {
    const numbers = take(Uint32Array, cells), status = take(Uint8Array, cells), sides = take(Uint8Array, cells);
    const centres = take(Uint16Array, 2 * cells), ring = take(Uint16Array, 2 * corners);
    const values = movie.quantities.map(() => take(Uint16Array, cells));
    const vectors = movie.arrows.map(() => take(Uint16Array, 2 * cells));
    return { label, time, cells, numbers, status, sides, centres, ring, values, vectors };
  });
  // Polygons and centres of the frame that is shown.
  const unpacked = (frame) => {
    if (!frame.polygons) {
      let corner = 0;
      frame.polygons = [...frame.sides].map((count) => Array.from({ length: count }, () => place(frame.ring, corner++)));
      frame.middles = [...frame.sides].map((_, cell) => place(frame.centres, cell));
    }
    return frame;
  };

  const canvas = part("canvas"), context = canvas.getContext("2d");
  const state = { frame: movie.first, pointed: null, followed: null, playing: false, timer: 0 };
  const chosen = (name) => Number(part(name).value);
  const shown = (name) => !part(name) || part(name).checked;
  const short = (number) => {
    if (!Number.isFinite(number)) return "–";
    const size = Math.abs(number);
    const [digits, power] = number.toExponential(2).split("e");
    const text = size === 0 || (size >= 1e-3 && size < 1e5) ? String(Number(number.toPrecision(3))) : `${digits}×10^${Number(power)}`;
    return text.replace("^-", "^−").replace(/^-/, "−");
  };
  const text = (...parts) => parts.filter((own) => own !== "").join(" ");

  // Letters after an underscore are subscripts, in the page and in the picture.
  const mark = (element, words) => element.replaceChildren(...words.split(/(_\w)/).map((own) => {
    if (!/^_\w$/.test(own)) return own;
    const sub = document.createElement("sub");
    sub.textContent = own[1];
    return sub;
  }));
  const FONT = '"Helvetica Neue", Helvetica, Arial, sans-serif';
  const write = (words, x, y, share = 0, most = Infinity) => {
    const parts = words.split(/(_\w)/).filter((own) => own).map((own) => {
      const isLow = /^_\w$/.test(own);
      context.font = `${isLow ? 10 : 13}px ${FONT}`;
      const letters = isLow ? own[1] : own;
      return { letters, isLow, font: context.font, wide: context.measureText(letters).width };
    });
    const wide = parts.reduce((sum, own) => sum + own.wide, 0);
    let at = Math.min(x - share * wide, most - wide);
    context.textAlign = "left";
    for (const own of parts) {
      context.font = own.font;
      context.fillText(own.letters, at, y + (own.isLow ? 3 : 0));
      at += own.wide;
    }
  };

  const STRIP = 84;
  let scale = 1, width = 0, height = 0;
  const [from, to] = movie.view;
  const pixel = ([x, y]) => [(x - from[0]) * scale, (to[1] - y) * scale];
  const trace = (polygon) => {
    polygon.forEach((corner, k) => context[k ? "lineTo" : "moveTo"](...pixel(corner)));
    context.closePath();
  };
  const resize = () => {
    const extent = [to[0] - from[0], to[1] - from[1]];
    const room = Math.max(part("live").clientWidth, 120);
    scale = Math.min(room / extent[0], Math.max(0.8 * window.innerHeight, 320) / extent[1]);
    [width, height] = extent.map((length) => length * scale);
    const ratio = window.devicePixelRatio || 1;
    canvas.width = Math.round(Math.max(width, Math.min(room, 320)) * ratio);
    canvas.height = Math.round((height + STRIP) * ratio);
    canvas.style.width = `${canvas.width / ratio}px`;
    canvas.style.height = `${canvas.height / ratio}px`;
    draw();
  };

  const hatch = document.createElement("canvas");
  hatch.width = hatch.height = 6;
  const lines = hatch.getContext("2d");
  lines.strokeStyle = "#9a9a9a";
  for (const shift of [-6, 0, 6]) {
    lines.moveTo(shift, 6);
    lines.lineTo(shift + 6, 0);
  }
  lines.stroke();

  const arrow = ([x, y], [dx, dy]) => {
    const size = Math.hypot(dx, dy);
    if (!(size >= 0.33)) return;
    const head = Math.min(0.42 * size, 6);
    const [ax, ay] = [(dx / size) * head, (dy / size) * head];
    const [bx, by] = [x + dx - ax, y + dy - ay];
    context.beginPath();
    context.moveTo(x, y);
    context.lineTo(bx, by);
    context.stroke();
    context.beginPath();
    context.moveTo(x + dx, y + dy);
    context.lineTo(bx - 0.38 * ay, by + 0.38 * ax);
    context.lineTo(bx + 0.38 * ay, by - 0.38 * ax);
    context.fill();
  };

  // Dark arrows are to be seen on all colours.
  const pale = () => (movie.arrows[chosen("arrows")] ? 0.62 : 1);
  const drawCells = (frame) => {
    const quantity = movie.quantities[chosen("colour")];
    const steps = frame.values[chosen("colour")];
    const unused = context.createPattern(hatch, "repeat");
    context.globalAlpha = pale();
    frame.polygons.forEach((polygon, cell) => {
      if (!polygon.length) return;
      const status = frame.status[cell];
      let fill = null;
      if (status === 0 && quantity) {
        const share = (value(steps[cell], quantity.range) - quantity.limits[0]) / (quantity.limits[1] - quantity.limits[0]);
        const level = Math.floor(Math.min(Math.max(share, 0), 1) * quantity.colours.length);
        fill = quantity.colours[Math.min(level, quantity.colours.length - 1)] || null;
      }
      const marked = shown("marks") && status > 0;
      if (marked) fill = status === 2 ? movie.not_detected + "29" : movie.left_out;
      if (!fill) return;
      context.fillStyle = fill;
      context.beginPath();
      trace(polygon);
      context.fill();
      if (marked && status === 3) {
        context.fillStyle = unused;
        context.fill();
      }
    });
    context.globalAlpha = 1;
    if (shown("outlines")) {
      context.beginPath();
      frame.polygons.forEach((polygon) => polygon.length && trace(polygon));
      context.strokeStyle = quantity ? "#fff" : "#8a8a8a";
      context.lineWidth = 0.9;
      context.stroke();
    }
    if (shown("marks")) {
      context.strokeStyle = movie.not_detected;
      context.lineWidth = 2;
      frame.middles.forEach((middle, cell) => {
        if (frame.status[cell] !== 2) return;
        context.beginPath();
        context.arc(...pixel(middle), Math.max(3, 0.16 * movie.spacing * scale), 0, 2 * Math.PI);
        context.stroke();
      });
    }
  };

  const drawArrows = (frame) => {
    const field = movie.arrows[chosen("arrows")];
    if (!field) return;
    const steps = frame.vectors[chosen("arrows")];
    context.strokeStyle = context.fillStyle = field.colour;
    context.lineWidth = 1.2;
    const long = field.stretch * scale;
    frame.middles.forEach((middle, cell) => {
      const [x, y] = [0, 1].map((axis) => value(steps[2 * cell + axis], [-field.most, field.most]));
      arrow(pixel(middle), [x * long, -y * long]);
    });
  };

  const drawLegend = () => {
    const across = canvas.clientWidth, top = height + 16;
    context.fillStyle = context.strokeStyle = "#222";
    context.lineWidth = 1.6;
    const bound = (0.22 * across) / scale, power = 10 ** Math.floor(Math.log10(bound));
    const length = [5, 2, 1].find((digit) => digit * power <= bound) * power;
    context.beginPath();
    for (const [a, b] of [[[4, -4], [4, 4]], [[4, 0], [4 + length * scale, 0]], [[4 + length * scale, -4], [4 + length * scale, 4]]]) {
      context.moveTo(a[0], top + a[1]);
      context.lineTo(b[0], top + b[1]);
    }
    context.stroke();
    write(text(short(length), movie.length_unit), 11 + length * scale, top + 4);
    const field = movie.arrows[chosen("arrows")];
    if (field) {
      const long = field.reference * field.stretch * scale;
      context.strokeStyle = context.fillStyle = field.colour;
      context.lineWidth = 1.2;
      const start = Math.min(0.52 * across, across - long - 7 * field.text.length - 12);
      arrow([start, top], [long, 0]);
      context.fillStyle = "#222";
      write(field.text, start + long + 7, top + 4, 0, across - 2);
    }
    const quantity = movie.quantities[chosen("colour")];
    if (!quantity) return;
    const [left, right, bar] = [0.08 * across, 0.92 * across, top + 14];
    const step = (right - left) / quantity.colours.length;
    context.globalAlpha = pale();
    quantity.colours.forEach((colour, level) => {
      context.fillStyle = colour;
      context.fillRect(left + level * step, bar, Math.min(step + (pale() < 1 ? 0 : 0.5), right - left - level * step), 11);
    });
    [[left, -9, 0], [right, 9, quantity.colours.length - 1]].forEach(([x, tip, level], side) => {
      if (!quantity.extended[side]) return;
      context.fillStyle = quantity.colours[level];
      context.beginPath();
      context.moveTo(x, bar);
      context.lineTo(x + tip, bar + 5.5);
      context.lineTo(x, bar + 11);
      context.fill();
    });
    context.globalAlpha = 1;
    context.fillStyle = "#222";
    for (const [position, label] of quantity.ticks) {
      const x = left + ((position - quantity.limits[0]) / (quantity.limits[1] - quantity.limits[0])) * (right - left);
      context.fillRect(x - 0.4, bar + 11, 0.8, 3.5);
      write(label, x, bar + 26, 0.5);
    }
    write(quantity.label, across / 2, bar + 43, 0.5);
  };

  const drawBorders = () => {
    if (!shown("borders")) return;
    context.lineWidth = 1.1;
    if (movie.outline) {
      const [[x0, y0], [x1, y1]] = movie.outline;
      context.strokeStyle = "#666";
      context.setLineDash([4, 3]);
      context.beginPath();
      trace([[x0, y0], [x1, y0], [x1, y1], [x0, y1]]);
      context.stroke();
      context.setLineDash([]);
    }
    context.strokeStyle = "#222";
    context.beginPath();
    movie.region.forEach((border) => trace(border));
    context.stroke();
  };

  const numbered = (frame, number) => (number === null ? -1 : frame.numbers.indexOf(number));
  const draw = () => {
    const frame = unpacked(frames[state.frame]);
    const ratio = window.devicePixelRatio || 1;
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, canvas.width, canvas.height);
    context.save();
    context.beginPath();
    context.rect(0, 0, width, height);
    context.clip();
    drawCells(frame);
    drawArrows(frame);
    drawBorders();
    for (const cell of [numbered(frame, state.followed), state.pointed]) {
      if (cell === null || cell < 0 || cell >= frame.cells) continue;
      context.strokeStyle = "#111";
      context.lineWidth = 2.4;
      context.beginPath();
      if (frame.polygons[cell].length) trace(frame.polygons[cell]);
      else context.arc(...pixel(frame.middles[cell]), 5, 0, 2 * Math.PI);
      context.stroke();
    }
    context.restore();
    context.strokeStyle = "#bbb";
    context.lineWidth = 0.8;
    context.strokeRect(0.4, 0.4, width - 0.8, height - 0.8);
    drawLegend();
    const time = frame.time === null ? "" : text(`t = ${short(frame.time)}`, movie.time_unit);
    mark(part("time"), [frame.label, time].filter((own) => own).join(", "));
    if (part("slider")) part("slider").value = state.frame;
    figure.dataset.frame = state.frame;
    mark(part("reading"), reading(frame));
  };

  // What is known of the cell that is pointed at, or else of the one that is followed.
  const reading = (frame) => {
    const cell = state.pointed ?? numbered(frame, state.followed);
    if (cell < 0 && state.followed !== null) return `Cell ${state.followed} is not in this frame.`;
    if (cell < 0 || cell >= frame.cells) return part("reading").dataset.hint;
    const number = frame.numbers[cell];
    const name = [number === 0xffffffff ? "a cell" : `cell ${number}`, STATUS[frame.status[cell]]].filter((own) => own).join(", ");
    const known = movie.quantities.map(({ name, unit, range, whole }, k) => {
      const own = value(frame.values[k][cell], range);
      return Number.isFinite(own) ? text(name, short(whole ? Math.round(own) : own), unit) : "";
    });
    const vectors = movie.arrows.map(({ name, unit, most }, k) => {
      const own = [0, 1].map((axis) => value(frame.vectors[k][2 * cell + axis], [-most, most]));
      return own.every(Number.isFinite) ? text(`${name} (${own.map(short).join(", ")})`, unit) : "";
    });
    return `${name}: ${[...known, ...vectors].filter((own) => own).join("; ")}`;
  };

  const inside = (polygon, [x, y]) => polygon.reduce((odd, [x1, y1], k) => {
    const [x0, y0] = polygon[(k || polygon.length) - 1];
    return (y0 > y) !== (y1 > y) && x < x0 + ((y - y0) / (y1 - y0)) * (x1 - x0) ? !odd : odd;
  }, false);
  const cellAt = (event) => {
    const corner = canvas.getBoundingClientRect(), frame = unpacked(frames[state.frame]);
    const [x, y] = [event.clientX - corner.left, event.clientY - corner.top];
    if (y > height || x > width) return null;
    const at = [from[0] + x / scale, to[1] - y / scale];
    const found = frame.polygons.findIndex((polygon) => inside(polygon, at));
    if (found >= 0) return found;
    const open = frame.middles.findIndex((middle, cell) => !frame.polygons[cell].length
      && Math.hypot(middle[0] - at[0], middle[1] - at[1]) < 0.5 * movie.spacing);
    return open >= 0 ? open : null;
  };

  const go = (frame) => {
    state.frame = Math.min(Math.max(frame, 0), frames.length - 1);
    state.pointed = null;
    draw();
  };
  const setPlaying = (playing) => {
    clearTimeout(state.timer);
    state.playing = playing && frames.length > 1;
    if (part("play")) {
      part("play").textContent = state.playing ? "Pause" : "Play";
      part("play").setAttribute("aria-pressed", state.playing);
    }
    if (!state.playing) return;
    if (state.frame === frames.length - 1) go(0);
    state.timer = setTimeout(tick, 1000 / chosen("speed"));
  };
  const tick = () => {
    const begun = performance.now(), last = state.frame === frames.length - 1;
    if (last && !shown("loop")) return setPlaying(false);
    go(last ? 0 : state.frame + 1);
    // Drawing takes some of the time.
    state.timer = setTimeout(tick, Math.max(1000 / chosen("speed") - (performance.now() - begun), 0));
  };
  const step = (by) => {
    setPlaying(false);
    go(state.frame + by);
  };

  const options = (name, list, none) => {
    const add = (label, index) => part(name).add(new Option(label, index));
    list.forEach((own, index) => add(own.name, index));
    add(none, -1);
    part(name).onchange = draw;
  };
  options("colour", movie.quantities, "nothing");
  options("arrows", movie.arrows, "none");
  const first = movie.quantities.length && movie.quantities[0].name.startsWith("residual");
  if (movie.arrows.length > 1 || first) part("arrows").value = -1;
  for (const name of ["outlines", "marks", "borders"]) if (part(name)) part(name).onchange = draw;
  if (part("play")) {
    part("play").onclick = () => setPlaying(!state.playing);
    part("back").onclick = () => step(-1);
    part("forward").onclick = () => step(1);
    part("slider").oninput = () => {
      setPlaying(false);
      go(Number(part("slider").value));
    };
  }
  canvas.onpointermove = (event) => {
    if (event.pointerType === "touch") return;
    const cell = cellAt(event);
    if (cell === state.pointed) return;
    state.pointed = cell;
    draw();
  };
  canvas.onpointerleave = () => {
    state.pointed = null;
    draw();
  };
  canvas.onclick = (event) => {
    const cell = cellAt(event), number = cell === null ? null : frames[state.frame].numbers[cell];
    state.followed = number === 0xffffffff || number === state.followed ? null : number;
    state.pointed = cell;
    draw();
  };
  figure.onkeydown = (event) => {
    if (["SELECT", "INPUT", "BUTTON"].includes(event.target.tagName)) return;
    const keys = {
      " ": () => setPlaying(!state.playing), ArrowLeft: () => step(-1), ArrowRight: () => step(1),
      Home: () => step(-frames.length), End: () => step(frames.length),
      Escape: () => { state.followed = state.pointed = null; draw(); },
    };
    if (!keys[event.key]) return;
    event.preventDefault();
    keys[event.key]();
  };

  figure.classList.add("is-live");
  part("live").hidden = false;
  window.addEventListener("resize", resize);
  resize();
}
