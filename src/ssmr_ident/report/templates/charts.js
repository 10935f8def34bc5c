// Charts: drawn when they come near, read out by mouse, finger and keyboard, zoomed, saved as PNG and CSV.
"use strict";
(() => {
  const root = document.documentElement;
  const colour = (role) => getComputedStyle(root).getPropertyValue(`--${role}`).trim();
  const decode = ({ low, step, n, size, data }) => {
    if (data === undefined) return Array.from({ length: n }, (_, k) => low + k * step);
    const bytes = Uint8Array.from(atob(data), (c) => c.charCodeAt(0));
    const words = size === 4 ? new Uint32Array(bytes.buffer) : new Uint16Array(bytes.buffer);
    const gap = 2 ** (8 * size) - 1;
    return Array.from(words, (w) => (w === gap ? null : low + w * step));
  };
  const shown = (value, digits = 4) => (value === null || value === undefined ? "–" : String(Number(value.toPrecision(digits))).replace("-", "−"));
  const unit = (name) => (name ? ` [${name}]` : "");
  const save = (blob, name) => {
    const link = document.createElement("a");
    link.href = URL.createObjectURL(blob);
    link.download = name;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 1000);
  };
  const built = [];

  const build = (figure) => {
    if (figure.dataset.drawn) return;
    figure.dataset.drawn = "yes";
    const spec = JSON.parse(figure.querySelector("script").textContent);
    const narrow = figure.classList.contains("hero") && innerWidth < 640;
    if (narrow) spec.rest = false; // the verdict's numbers stay on the first screen
    const x = decode(spec.x), courses = spec.lines.map((line) => decode(line.y));
    const holder = figure.querySelector(".plot");
    const legend = figure.querySelector(".legend"), spoken = figure.querySelector(".spoken");
    const whole = [x[0], x[x.length - 1]];
    const panels = [];

    const at = document.createElement("li");
    const places = spec.lines.map((line) => {
      const item = document.createElement("li"), value = document.createElement("output");
      item.innerHTML = `<i class="${line.role}" aria-hidden="true"></i>`;
      item.append(line.label, " ", value);
      value.setAttribute("aria-live", "off");
      if (line.role !== "limit") legend.append(item);
      return value;
    });
    legend.append(at);
    const read = (k) => {
      at.textContent = k === null ? "" : `at ${shown(x[k], 6)} ${spec.xUnit}`;
      places.forEach((place, c) => { place.textContent = k === null ? "" : shown(courses[c][k]); });
    };

    const room_of = (low, high) => { // for the digits of a tick at the finest step of about ten
      const step = (high - low) / 10, places = Math.max(0, -Math.floor(Math.log10(step)) + 1);
      return Math.max(50, 14 + 6.5 * (String(Math.trunc(Math.max(Math.abs(low), Math.abs(high)))).length + places + 1));
    };
    const axis = (side, label, size) => ({
      space: side === 2 ? (u, index, low, high) => room_of(low, high) : 30,
      stroke: () => colour("ink"), grid: { stroke: () => colour("line"), width: 1 }, ticks: { stroke: () => colour("line") },
      label, labelSize: 16, labelFont: "12px system-ui, sans-serif", font: "11px system-ui, sans-serif", size, labelGap: 0, gap: 3,
      values: (_, splits) => splits.map((v) => (v === null ? "" : String(Number(v.toPrecision(10))).replace("-", "−"))), side,
    });
    const line = (role, label) => ({
      label, stroke: () => colour(role), width: role === "recorded" ? 3 : role === "limit" ? 0.5 : 1.4, points: { show: false }, spanGaps: false, pxAlign: 0,
    });
    const largest = courses.flat().reduce((most, v) => (v === null ? most : Math.max(most, Math.abs(v))), 0);
    const room = largest < 0.02 || largest >= 1e4 ? 74 : 50; // for the digits of its ticks, alike in both panels
    let moving = false;
    const follow = (u) => {
      if (moving) return;
      moving = true;
      for (const other of panels) if (other !== u) other.setScale("x", { min: u.scales.x.min, max: u.scales.x.max });
      moving = false;
    };
    const panel = (height, series, data, yLabel, last) => {
      const options = {
        width: holder.clientWidth, height, padding: [8, 14, 0, 0], legend: { show: false }, scales: { x: { time: false } },
        cursor: { y: false, sync: { key: spec.name }, drag: { x: true, y: false }, points: { size: 5 }, focus: { prox: -1 } },
        axes: [axis(2, last ? `${spec.xLabel}${unit(spec.xUnit)}` : undefined, last ? 34 : 0), axis(3, yLabel, room)],
        series: [{}, ...series],
        hooks: { setCursor: [(u) => u === panels[0] && read(u.cursor.idx ?? null)], setScale: [(u, key) => key === "x" && follow(u)] },
      };
      if (!last) options.axes[0].show = false;
      if (spec.band) options.bands = [{ series: [series.length, series.length - 1], fill: () => colour("band") }];
      panels.push(new uPlot(options, data, holder));
    };
    const [high, low] = [narrow ? 175 : Number(figure.dataset.height), spec.rest ? 130 : 0];
    panel(high - low, spec.lines.map((l) => line(l.role, l.label)), [x, ...courses], `${spec.yLabel}${unit(spec.yUnit)}`, !spec.rest);
    if (spec.rest) {
      const rest = courses.slice(1).map((c) => c.map((v, k) => (v === null || courses[0][k] === null ? null : courses[0][k] - v)));
      panel(low, spec.lines.slice(1).map((l) => line(l.role, l.label)), [x, ...rest], `residual${unit(spec.yUnit)}`, true);
    }
    const zoom = ([a, b]) => panels[0].setScale("x", { min: Math.max(a, whole[0]), max: Math.min(b, whole[1]) });
    const span = () => [panels[0].scales.x.min, panels[0].scales.x.max];
    const scaled = (factor) => {
      const [a, b] = span(), k = panels[0].cursor.idx, middle = k === null || k === undefined ? (a + b) / 2 : x[k];
      zoom([middle - (middle - a) * factor, middle + (b - middle) * factor]);
    };
    const all = () => zoom(whole);
    if (spec.shown) zoom(spec.shown);

    const point = (k) => {
      const u = panels[0], [a, b] = span();
      if (x[k] < a || x[k] > b) zoom([x[k] - (b - a) / 2, x[k] + (b - a) / 2]);
      u.setCursor({ left: u.valToPos(x[k], "x"), top: u.over.clientHeight / 2 });
      const values = spec.lines.map((l, c) => (l.role === "limit" ? "" : `, ${l.label} ${shown(courses[c][k])}`)).join("");
      spoken.textContent = `${spec.xLabel} ${shown(x[k], 6)} ${spec.xUnit}${values}`;
    };
    holder.addEventListener("keydown", (event) => {
      const seen = (() => { const [a, b] = span(); return x.filter((v) => v >= a && v <= b).length; })();
      const step = event.shiftKey ? Math.max(1, Math.round(seen / 20)) : 1;
      const k = panels[0].cursor.idx ?? x.findIndex((v) => v >= span()[0]);
      const keys = {
        ArrowLeft: () => point(Math.max(0, k - step)), ArrowRight: () => point(Math.min(x.length - 1, k + step)),
        "+": () => scaled(0.5), "-": () => scaled(2), 0: all, Home: all, Escape: () => { panels[0].setCursor({ left: -10, top: -10 }); read(null); },
      };
      if (keys[event.key]) { event.preventDefault(); keys[event.key](); }
    });

    const png = () => {
      const ratio = devicePixelRatio, sources = panels.map((u) => u.ctx.canvas), head = 40 * ratio;
      const sheet = document.createElement("canvas");
      sheet.width = Math.max(...sources.map((s) => s.width));
      sheet.height = head + sources.reduce((sum, s) => sum + s.height, 0);
      const pen = sheet.getContext("2d");
      pen.fillStyle = colour("paper"); pen.fillRect(0, 0, sheet.width, sheet.height);
      pen.font = `${12 * ratio}px system-ui, sans-serif`; pen.fillStyle = colour("ink"); pen.fillText(spec.title, 8 * ratio, 15 * ratio);
      let left = 8 * ratio;
      for (const l of spec.lines.filter((l) => l.role !== "limit")) {
        pen.fillStyle = colour(l.role); pen.fillRect(left, 27 * ratio, 14 * ratio, 3 * ratio); left += 18 * ratio;
        pen.fillStyle = colour("ink"); pen.fillText(l.label, left, 33 * ratio); left += pen.measureText(l.label).width + 14 * ratio;
      }
      let top = head;
      for (const source of sources) { pen.drawImage(source, 0, top); top += source.height; }
      sheet.toBlob((blob) => save(blob, `${spec.name}.png`));
    };
    const csv = () => {
      const quoted = (text) => (/[",\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text);
      const rows = [[`${spec.xLabel}${unit(spec.xUnit)}`, ...spec.lines.map((l) => `${l.label}${unit(spec.yUnit)}`)].map(quoted).join(",")];
      x.forEach((v, k) => rows.push([v, ...courses.map((c) => c[k])].map((n) => (n === null ? "" : Number(n.toPrecision(7)))).join(",")));
      save(new Blob([rows.join("\n") + "\n"], { type: "text/csv" }), `${spec.name}.csv`);
    };
    const bar = figure.querySelector(".tools");
    const add = (text, label, action) => {
      const button = document.createElement("button");
      button.type = "button"; button.textContent = text; button.setAttribute("aria-label", `${label}: ${spec.title}`); button.title = label;
      button.addEventListener("click", action);
      bar.append(button);
    };
    add("+", "Zoom in", () => scaled(0.5)); add("−", "Zoom out", () => scaled(2)); add("All", "Show all", all);
    add("PNG", "Save as PNG", png); add("CSV", "Save as CSV", csv);
    const fit = (width) => panels.forEach((u) => u.setSize({ width, height: u.height }));
    built.push({ redraw: () => panels.forEach((u) => u.redraw(false)), fit, holder });
    new ResizeObserver(() => { if (!root.classList.contains("printing") && holder.clientWidth !== panels[0].width) fit(holder.clientWidth); }).observe(holder);
    figure.chart = { zoom, span, all, panels };
  };

  const figures = [...document.querySelectorAll("figure.chart")];
  const near = new IntersectionObserver((entries) => entries.forEach((e) => { if (e.isIntersecting) { near.unobserve(e.target); build(e.target); } }), { rootMargin: "600px" });
  figures.forEach((figure) => (figure.classList.contains("hero") ? build(figure) : near.observe(figure)));
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => built.forEach((c) => c.redraw()));
  addEventListener("beforeprint", () => {
    root.classList.add("printing");
    figures.forEach(build);
    built.forEach((c) => { c.fit(Math.min(c.holder.clientWidth, 640)); c.redraw(); });
  });
  addEventListener("afterprint", () => {
    root.classList.remove("printing");
    built.forEach((c) => { c.fit(c.holder.clientWidth); c.redraw(); });
  });
})();
