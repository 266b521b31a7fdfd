// The tab "Study", the line under the sliders and the strips on them: drawn as SVG of the data that the server sends in
// <trackride-study-data>. What the user chooses there is kept by the browser, and told to the server through a hidden box.
if (!window.trackrideStudy) {
  const KEPT = 'trackride-study';  // in the browser's storage
  const VIEWS = {profiler: 'Profiler', map: 'Map', limits: 'Limits', measured: 'Measured'};
  const study = window.trackrideStudy = {data: {}, views: {}, offer: null, choice: {}, page: null, large: false};

  // ── Talking with the server ──
  const waiting = new Map();  // kind -> content that is still to be told: the newest counts
  let count = 0;
  const inTurn = (act) => (window.trackrideInTurn ?? setTimeout)(act);
  // Hidden boxes: one in the tab, one beside the sliders. Each is there while its panel is
  const sayBoxes = () => [...document.querySelectorAll('trackride-study, trackride-matters')].flatMap(({dataset}) => {
    let part = document.querySelector(`label[for="${dataset.says}"]`);
    while (part && !part.querySelector('input')) part = part.parentElement;
    return part ?? [];
  });
  const tell = (kind, content) => {
    const known = waiting.has(kind);
    waiting.set(kind, content);
    if (!known) inTurn(() => {
      const box = sayBoxes()[0]?.querySelector('input'), newest = waiting.get(kind);
      waiting.delete(kind);
      if (!box) return;
      const text = JSON.stringify({kind, content: newest, count: ++count});
      Object.getOwnPropertyDescriptor(HTMLInputElement.prototype, 'value').set.call(box, text);  // past React's own
      box.dispatchEvent(new Event('input', {bubbles: true}));
    });
  };
  const choose = (changes) => {
    Object.assign(study.choice, changes);
    localStorage.setItem(KEPT, JSON.stringify(study.choice));
    tell('choice', study.choice);
    draw();
    strips();
    matters();
  };
  const keepingFocus = (within, rebuild) => {  // on the same button or list after it is made anew
    const all = () => [...within.querySelectorAll('button, select, summary, input')];
    const place = all().indexOf(document.activeElement);
    rebuild();
    all()[place]?.focus({preventScroll: true});
  };

  // ── Numbers ──
  const words = (value, digits = 3) => {
    if (value === null || value === undefined || !Number.isFinite(value)) return '–';
    const size = Math.abs(value) < 1e-3 ? 0 : Math.abs(value);
    const text = size >= 10 ** digits || size === 0 ? (value.toFixed(0) - 0).toFixed(0) : String(Number(value.toPrecision(digits)));
    return text.replace('-', '−');
  };
  const ticks = (low, high, most) => {  // round numbers, `most` or fewer
    const span = high - low || 1, power = 10 ** Math.floor(Math.log10(span / most));
    const step = power * [1, 2, 5, 10].find((factor) => span / (factor * power) <= most + 1e-9);
    const first = Math.ceil(low / step - 1e-9), last = Math.floor(high / step + 1e-9);
    return Array.from({length: Math.max(last - first + 1, 0)}, (_, k) => Number(((first + k) * step).toPrecision(12)));
  };
  const inMetric = (value, {metric: [, factor]}) => Number.isFinite(value) ? Number((value / factor).toPrecision(6)) : value;
  const heading = ({label, metric: [unit]}) => `${label} [${unit}]`;  // of a column in a file
  const snap = (column, value) => {  // to what the slider takes
    const whole = column.first + Math.round((value - column.first) / column.step) * column.step;
    return Number(Math.min(Math.max(whole, column.low), column.high).toPrecision(10));
  };

  // ── Drawing ──
  const make = (tag, attributes = {}, ...children) => {
    const element = document.createElementNS('http://www.w3.org/2000/svg', tag);
    for (const [name, value] of Object.entries(attributes)) if (value !== undefined) element.setAttribute(name, value);
    element.append(...children);
    return element;
  };
  const html = (tag, properties = {}, ...children) => {
    const element = Object.assign(document.createElement(tag), properties);
    element.append(...children);
    return element;
  };
  const LIGHT = {
    ink: '#212529', dim: '#5c6670', line: '#1c6cb2', now: '#c2410c', grid: '#80808038', frame: '#80808066', back: '#ffffff',
  };
  const DARK = {...LIGHT, ink: '#c9c9c9', dim: '#a3a3a3', line: '#74b9ff', now: '#ff9d5c', back: '#242424'};
  const isDark = () => document.documentElement.dataset.mantineColorScheme === 'dark';
  const look = () => isDark() ? DARK : LIGHT;
  const FONT = 'system-ui, sans-serif';
  const text = (x, y, content, {size = 10.5, fill, anchor = 'start', weight = 400, turn, title} = {}) => {
    const element = make('text', {
      x: x.toFixed(1), y: y.toFixed(1), 'font-size': size, fill, 'text-anchor': anchor, 'font-weight': weight,
      'font-family': FONT, transform: turn && `rotate(${turn} ${x.toFixed(1)} ${y.toFixed(1)})`,
    }, content);
    if (title) element.append(make('title', {}, title));
    return element;
  };
  const pen = document.createElement('canvas').getContext('2d');
  const widthOf = (content, size, weight = 400) => {
    pen.font = `${weight} ${size}px ${FONT}`;
    return pen.measureText(content).width;
  };
  const scale = (from, to, low, high) => (value) => from + (value - low) / (high - low || 1) * (to - from);
  const path = (xs, ys, x, y) => {  // broken where there is no number
    let down = false;
    return xs.map((value, k) => {
      if (ys[k] === null) return (down = false, '');
      const point = `${down ? 'L' : 'M'}${x(value).toFixed(1)} ${y(ys[k]).toFixed(1)}`;
      down = true;
      return point;
    }).join('');
  };
  const area = (xs, low, high, x, y) => {
    const known = xs.map((_, k) => k).filter((k) => low[k] !== null && high[k] !== null);
    if (known.length < 2) return '';
    const there = known.map((k) => `${x(xs[k]).toFixed(1)} ${y(high[k]).toFixed(1)}`);
    const back = known.reverse().map((k) => `${x(xs[k]).toFixed(1)} ${y(low[k]).toFixed(1)}`);
    return `M${there.join('L')}L${back.join('L')}Z`;
  };
  const at = (xs, ys, value) => {  // on the lines between points
    const k = xs.findIndex((x) => x >= value);
    if (k < 0) return null;
    if (k === 0 || xs[k] === value) return ys[k];
    const part = (value - xs[k - 1]) / (xs[k] - xs[k - 1]);
    return ys[k] === null || ys[k - 1] === null ? null : ys[k - 1] + part * (ys[k] - ys[k - 1]);
  };
  const wrapped = (words_, most) => {  // lines of about so many letters
    const lines = [''];
    words_.split(' ').forEach((word) => {
      if (lines.at(-1) && lines.at(-1).length + word.length + 1 > most) lines.push(word);
      else lines.push(`${lines.pop()} ${word}`.trim());
    });
    return lines;
  };

  // ── Profiler ──
  const present = (column) => {  // where the slider stands now, which may be newer than the curves
    const id = study.sliders?.[column.key];
    const thumb = id && document.getElementById(id)?.querySelector('[role="slider"]');
    return thumb ? Number(thumb.getAttribute('aria-valuenow')) : column.now;
  };
  const effectWords = (figure, columns, most) => figure.effects.filter(([, reach]) => reach > 0).slice(0, most)
    .map(([key, reach, way], k) => {
      const label = columns.find((column) => column.key === key).label;
      return `${k ? label.toLowerCase() : label} ${{'1': '+', '-1': '−', '0': '±'}[way]}${words(reach)}`;
    }).join(', ');
  const profiler = (data, width, height, colours) => {
    const columns = data.columns.filter(({shown}) => shown), rows = data.figures.map((figure, k) => ({...figure, k}))
      .filter(({shown}) => shown);
    const left = 38, right = 8, gap = width / columns.length < 90 ? 7 : 14, head = 19, between = 9;
    const wide = (width - left - right - gap * (columns.length - 1)) / columns.length;
    const names = columns.map(({label}) => wrapped(label, Math.max(wide / 5.6, 9)));
    const foot = 16 + 12 * (Math.max(...names.map(({length}) => length)) + 1) + 3;
    const high = Math.max((height - foot) / rows.length - head - between, 40);
    const total = rows.length * (head + high + between) + foot;
    const svg = make('svg', {
      viewBox: `0 0 ${width} ${total}`, width, height: total, xmlns: 'http://www.w3.org/2000/svg', role: 'img',
      'aria-label': rows.map((row) => `${row.label} ${words(row.now)} ${row.unit}: ${effectWords(row, columns, 3)}`).join('. '),
    });
    const panels = [];
    rows.forEach((row, r) => {
      const top = r * (head + high + between) + head, bottom = top + high;
      const all = columns.flatMap(({y, band, baseline}) => [
        ...y[row.k], ...(band ? [...band.low[row.k], ...band.high[row.k]] : []), ...(baseline ? baseline.y[row.k] : []),
      ]).filter((value) => value !== null);
      let [least, most] = [Math.min(...all, row.now ?? Infinity), Math.max(...all, row.now ?? -Infinity)];
      if (!Number.isFinite(least)) [least, most] = [0, 1];
      if (least >= 0) least = 0;
      if (most - least < 1e-9) most = least + 1;
      most += 0.06 * (most - least);
      const y = scale(bottom, top, least, most), heights = ticks(least, most, Math.max(high / 26, 2));
      heights.forEach((tick) => svg.append(
        text(left - 5, y(tick) + 3.5, words(tick), {fill: colours.dim, anchor: 'end', size: 10}),
      ));
      const unit = row.unit ? ` ${row.unit}` : '';
      const name = text(left, top - 6, row.label, {fill: colours.ink, weight: 600, size: 11.5});
      name.append(make('tspan', {fill: colours.now, dx: 7}, `${words(row.now)}${unit}`));
      if (row.before !== null)
        name.append(make('tspan', {fill: colours.dim, dx: 6, 'font-weight': 400}, `baseline ${words(row.before)}`));
      const room = width - right - left - widthOf(name.textContent, 11.5, 600) - 28;
      let told = '';
      for (let k = 1; k <= 3; k++) {
        const longer = effectWords(row, data.columns, k) + unit;
        if (widthOf(longer, 10.5) <= room) told = longer;
      }
      svg.append(name, text(width - right, top - 6, told, {fill: colours.dim, anchor: 'end'}));
      columns.forEach((column, c) => {
        const start = left + c * (wide + gap), end = start + wide;
        const x = scale(start, end, column.low, column.high), inside = make('g', {class: 'panel'});
        inside.append(make('rect', {x: start, y: top, width: wide, height: high, fill: 'transparent', stroke: colours.frame}));
        heights.forEach((tick) => inside.append(
          make('path', {d: `M${start} ${y(tick).toFixed(1)}H${end}`, stroke: colours.grid, fill: 'none'}),
        ));
        if (column.band) inside.append(make('path', {
          d: area(column.band.x, column.band.low[row.k], column.band.high[row.k], x, y), fill: colours.line, opacity: 0.18,
        }));
        if (column.baseline) inside.append(make('path', {
          d: path(column.baseline.x, column.baseline.y[row.k], x, y), fill: 'none', stroke: colours.line, 'stroke-width': 1.3,
          'stroke-dasharray': '4 3', opacity: 0.6,
        }));
        if (row.bound !== null && row.bound < most) inside.append(make('path', {
          d: `M${start} ${y(row.bound).toFixed(1)}H${end}`, stroke: colours.ink, 'stroke-dasharray': '6 3', fill: 'none', opacity: 0.55,
        }));
        if (row.now !== null) inside.append(make('path', {
          d: `M${start} ${y(row.now).toFixed(1)}H${end}`, stroke: colours.now, 'stroke-dasharray': '1 3', fill: 'none',
        }));
        inside.append(make('path', {
          d: path(column.x, column.y[row.k], x, y), fill: 'none', stroke: colours.line, 'stroke-width': 1.8,
          'stroke-linejoin': 'round',
        }));
        const marker = make('g', {class: 'now'});
        inside.append(marker);
        svg.append(inside);
        panels.push({column, row, x, y, start, end, top, bottom, marker});
      });
    });
    const base = total - foot;
    const cells = columns.map((column, c) => {
      const start = left + c * (wide + gap), x = scale(start, start + wide, column.low, column.high);
      const narrow = wide < 110, marks = narrow ? [column.low, column.high] : ticks(column.low, column.high, wide / 34);
      marks.forEach((tick) => svg.append(
        make('path', {d: `M${x(tick).toFixed(1)} ${base - between}v4`, stroke: colours.frame}),
        text(x(tick), base + 6, words(tick, 4), {
          fill: colours.dim, size: 10, anchor: x(tick) < start + 8 ? 'start' : x(tick) > start + wide - 8 ? 'end' : 'middle',
        }),
      ));
      names[c].forEach((line, k) => svg.append(
        text(start + wide / 2, base + 21 + 12 * k, line, {fill: colours.ink, anchor: 'middle', weight: 500}),
      ));
      svg.append(text(start + wide / 2, base + 21 + 12 * names[c].length, column.unit, {fill: colours.dim, anchor: 'middle'}));
      return {column, start, wide, top: base + 10, height: 12 * names[c].length + 2};
    });
    const mark = () => panels.forEach(({column, row, x, y, top, bottom, start, end, marker}) => {
      const value = present(column);
      if (marker.value === value) return;
      marker.value = value;
      marker.replaceChildren();
      if (value === null) return;
      const place = Math.min(Math.max(x(value), start), end).toFixed(1), height = at(column.x, column.y[row.k], value);
      marker.append(make('path', {d: `M${place} ${top}V${bottom}`, stroke: colours.now, 'stroke-width': 1.4}));
      if (height !== null) marker.append(make('circle', {
        cx: place, cy: y(height).toFixed(1), r: 3, fill: colours.now, stroke: colours.back, 'stroke-width': 1,
      }));
    });
    mark();
    return {svg, panels, rows, cells, mark, left, head, size: [width, total], step: head + high + between};
  };

  const options = (names, chosen) => names.map(([value, label]) =>
    html('option', {value, textContent: label, selected: value === chosen}));
  const picker = (label, box, choices, chosen, act) => {  // an unseen list over a name that is drawn
    const list = html('select', {title: label, ariaLabel: label}, ...options(choices, chosen));
    Object.assign(list.style, {left: `${box[0]}px`, top: `${box[1]}px`, width: `${box[2]}px`, height: `${box[3]}px`});
    list.onchange = () => act(list.value);
    return list;
  };
  study.views.profiler = {
    empty: 'Curves come when you rest for a moment.',
    draw(body, data, width, height) {
      const drawn = profiler(data, width, height, look());
      const {svg, panels} = drawn;
      const {columns, rows} = study.choice, {figures, keys} = study.offer;
      const figureList = figures.map(({name, label}) => [name, label]);
      const keyList = keys.map(([key, label, group]) => [key, `${group}: ${label}`]);
      const swap = (list, old, other) => list.includes(other) ? list : list.map((one) => one === old ? other : one);
      const lists = [
        ...drawn.rows.map((row, r) => picker('Another figure', [drawn.left, r * drawn.step, 6.4 * row.label.length, drawn.head],
          [...figureList, ['', '– remove this row –']], row.name, (other) => choose({
            rows: other ? swap(rows, row.name, other) : rows.length > 1 ? rows.filter((one) => one !== row.name) : rows,
          }))),
        ...drawn.cells.map(({column, start, wide, top, height: tall}) => picker('Another parameter', [start, top, wide, tall],
          [...keyList, ['', '– remove this column –']], column.key, (other) => choose({
            columns: other ? swap(columns, column.key, other)
              : columns.length > 1 ? columns.filter((one) => one !== column.key) : columns,
          }))),
      ];
      const readout = html('div', {className: 'readout', hidden: true});
      const place = (event) => {
        const box = svg.getBoundingClientRect(), zoom = box.width / drawn.size[0];
        return [(event.clientX - box.left) / zoom, (event.clientY - box.top) / zoom];
      };
      const panelAt = ([x, y]) => panels.find((one) => x >= one.start - 2 && x <= one.end + 2 && y >= one.top && y <= one.bottom);
      const valueAt = (panel, x) => panel.column.low
        + (x - panel.start) / (panel.end - panel.start) * (panel.column.high - panel.column.low);
      let held = null;
      const steer = (event) => {
        const value = snap(held.column, valueAt(held, place(event)[0]));
        if (value === held.told) return;
        tell('set', {[held.column.key]: held.told = value});
        held.column.now = study.sliders[held.column.key] ? held.column.now : value;  // ahead of the server
        drawn.mark();
      };
      svg.addEventListener('pointerdown', (event) => {
        held = event.button ? null : panelAt(place(event));
        if (!held) return;
        held.told = undefined;
        svg.setPointerCapture(event.pointerId);
        steer(event);
        event.preventDefault();
      });
      svg.addEventListener('pointermove', (event) => {
        if (held) steer(event);
        const spot = place(event), panel = held ?? panelAt(spot);
        readout.hidden = !panel;
        if (!panel) return;
        const {column, row} = panel, value = snap(column, valueAt(panel, spot[0]));
        const figure = at(column.x, column.y[row.k], value);
        readout.textContent = `${column.label} ${words(value, 4)} ${column.unit}: `
          + (figure === null ? 'no complete run' : `${words(figure)} ${row.unit}`);
        readout.style.top = `${panel.top - drawn.head}px`;
        readout.style.left = `${Math.min(Math.max(spot[0], 90), drawn.size[0] - 90)}px`;
      });
      svg.addEventListener('pointerup', () => held = null);
      svg.addEventListener('pointercancel', () => held = null);
      svg.addEventListener('pointerleave', () => { if (!held) readout.hidden = true; });
      body.replaceChildren(svg, ...lists, readout);
      return {mark: drawn.mark, held: () => held !== null};
    },
    more: () => {
      const add = (label, names, list) => {
        const box = html('select', {ariaLabel: label}, html('option', {value: '', textContent: label}), ...options(names));
        box.onchange = () => box.value && !study.choice[list].includes(box.value)
          && choose({[list]: [...study.choice[list], box.value]});
        return box;
      };
      return [
        add('+ parameter', study.offer.keys.map(([key, label, group]) => [key, `${group}: ${label}`]), 'columns'),
        add('+ figure', study.offer.figures.map(({name, label}) => [name, label]), 'rows'),
      ];
    },
    picture: (data) => {
      const count_ = data.columns.filter(({shown}) => shown).length, rows = data.figures.filter(({shown}) => shown).length;
      return profiler(data, Math.max(200 * count_ + 60, 600), 155 * rows + 60, LIGHT).svg;
    },
    table: (data) => {
      const rows = data.figures.map((figure, k) => ({...figure, k})).filter(({shown}) => shown);
      return [['parameter', 'unit', 'value', ...rows.map(heading)], ...data.columns.filter(({shown}) => shown).flatMap((column) =>
        column.x.map((value, k) => [column.label, column.metric[0], inMetric(value, column),
          ...rows.map((row) => inMetric(column.y[row.k][k], row))]))];
    },
  };

  // ── Map ──
  const RAMP = {  // from little to much: lightness tells it too
    light: [[247, 251, 255], [198, 219, 239], [107, 174, 214], [33, 113, 181], [8, 48, 107]],
    dark: [[24, 28, 38], [22, 58, 98], [36, 106, 164], [106, 172, 214], [224, 240, 252]],
  };
  const colourAt = (part, ramp) => {
    const along = Math.min(Math.max(part, 0), 1) * (ramp.length - 1), k = Math.min(Math.floor(along), ramp.length - 2);
    return `rgb(${ramp[k].map((one, c) => Math.round(one + (along - k) * (ramp[k + 1][c] - one)))})`;
  };
  const between = (values, fx, fy) => {  // on a grid, at fractions of its places; null beside a gap
    const [rows, columns] = [values.length, values[0].length];
    const [i, j] = [Math.min(Math.floor(fx), columns - 2), Math.min(Math.floor(fy), rows - 2)], [u, v] = [fx - i, fy - j];
    const four = [values[j][i], values[j][i + 1], values[j + 1][i], values[j + 1][i + 1]];
    if (four.includes(null)) return values[Math.round(fy)][Math.round(fx)];
    return four[0] * (1 - u) * (1 - v) + four[1] * u * (1 - v) + four[2] * (1 - u) * v + four[3] * u * v;
  };
  const contour = (values, level, x, y) => {  // the line at a level: where it crosses the triangles of each cell
    let line = '';
    for (let j = 0; j + 1 < values.length; j++) for (let i = 0; i + 1 < values[0].length; i++) {
      const corners = [[i, j], [i + 1, j], [i + 1, j + 1], [i, j + 1]];
      if (corners.some(([a, b]) => values[b][a] === null)) continue;
      for (const three of [[0, 1, 2], [0, 2, 3]]) {
        const cuts = [];
        for (let k = 0; k < 3; k++) {
          const [p, q] = [corners[three[k]], corners[three[(k + 1) % 3]]], [from, to] = [values[p[1]][p[0]], values[q[1]][q[0]]];
          if ((from < level) === (to < level)) continue;
          const part = (level - from) / (to - from);
          cuts.push(`${x(p[0] + part * (q[0] - p[0])).toFixed(1)} ${y(p[1] + part * (q[1] - p[1])).toFixed(1)}`);
        }
        if (cuts.length === 2) line += `M${cuts.join('L')}`;
      }
    }
    return line;
  };
  const FINE = 6;  // squares in each cell of the grid, along each side
  const figureMap = (data, width, height, colours, ramp) => {
    const {x: across, y: up, values, figure} = data, left = 52, right = 66, top = 24, foot = 40;
    const high = Math.min(height - top - foot, 1.1 * (width - left - right)), end = width - right, bottom = top + high;
    const total = bottom + foot;
    const x = scale(left, end, across.low, across.high), y = scale(bottom, top, up.low, up.high);
    const i = (place) => scale(left, end, 0, across.at.length - 1)(place), j = (place) => scale(bottom, top, 0, up.at.length - 1)(place);
    const all = values.flat().filter((value) => value !== null);
    const [least, most] = all.length ? [Math.min(...all), Math.max(...all)] : [0, 1];
    // Half of all runs get half of the ramp, or one run that goes wild would leave all others one colour
    const sorted = [...all].sort((a, b) => a - b), middle = sorted[Math.floor(sorted.length / 2)] ?? 0;
    const bend = most > least ? Math.log(0.5) / Math.log(Math.min(Math.max((middle - least) / (most - least), 0.03), 0.97)) : 1;
    const part = (value) => most > least ? ((value - least) / (most - least)) ** bend : 0;
    const svg = make('svg', {
      viewBox: `0 0 ${width} ${total}`, width, height: total, xmlns: 'http://www.w3.org/2000/svg', role: 'img',
      'aria-label': `${figure.label} over ${across.label} and ${up.label}`,
    });
    svg.append(text(left, 15, `${figure.label}${figure.unit ? `, ${figure.unit}` : ''}`, {fill: colours.ink, weight: 600, size: 11.5}));
    const [columns, rows] = [(across.at.length - 1) * FINE, (up.at.length - 1) * FINE];
    const canvas = html('canvas', {width: columns, height: rows}), paint = canvas.getContext('2d');
    for (let r = 0; r < rows; r++) for (let c = 0; c < columns; c++) {
      const value = between(values, (c + 0.5) / FINE, (r + 0.5) / FINE);
      if (value === null) continue;
      paint.fillStyle = colourAt(part(value), ramp);
      paint.fillRect(c, rows - 1 - r, 1, 1);
    }
    svg.append(make('rect', {x: left, y: top, width: end - left, height: high, fill: colours.grid}));
    svg.append(make('image', {href: canvas.toDataURL(), x: left, y: top, width: end - left, height: high, preserveAspectRatio: 'none'}));
    // Lines where the ramp has gone on by a sixth, at round numbers
    const digits = (value) => Number(value.toPrecision(2));
    const levels = most > least
      ? [...new Set([1, 2, 3, 4, 5].map((k) => digits(least + (k / 6) ** (1 / bend) * (most - least))))] : [];
    levels.forEach((level) => svg.append(make('path', {
      d: contour(values, level, i, j), fill: 'none', stroke: part(level) > 0.5 === (ramp === RAMP.light) ? '#ffffffc0' : '#000000a0',
      'stroke-width': 1,
    })));
    const {bound} = figure;
    if (bound !== null && bound > least && bound < most) svg.append(make('path', {
      d: contour(values, bound, i, j), fill: 'none', stroke: colours.now, 'stroke-width': 2.2,
    }), text(end, 15, `line: ${words(bound)} ${figure.unit}`, {fill: colours.now, anchor: 'end'}));
    ticks(across.low, across.high, (end - left) / 50).forEach((tick) => svg.append(
      make('path', {d: `M${x(tick).toFixed(1)} ${bottom}v4`, stroke: colours.frame}),
      text(x(tick), bottom + 15, words(tick, 4), {fill: colours.dim, size: 10, anchor: 'middle'})));
    ticks(up.low, up.high, high / 40).forEach((tick) => svg.append(
      make('path', {d: `M${left} ${y(tick).toFixed(1)}h-4`, stroke: colours.frame}),
      text(left - 7, y(tick) + 3.5, words(tick, 4), {fill: colours.dim, size: 10, anchor: 'end'})));
    svg.append(text((left + end) / 2, bottom + 32, `${across.label}, ${across.unit}`, {fill: colours.ink, anchor: 'middle', weight: 500}));
    svg.append(text(13, (top + bottom) / 2, `${up.label}, ${up.unit}`, {fill: colours.ink, anchor: 'middle', weight: 500, turn: -90}));
    const bar = end + 12, COUNT = 60;
    for (let k = 0; k < COUNT; k++) svg.append(make('rect', {
      x: bar, y: (bottom - (k + 1) / COUNT * high).toFixed(2), width: 11, height: (high / COUNT + 0.5).toFixed(2),
      fill: colourAt((k + 0.5) / COUNT, ramp),
    }));
    [least, ...levels, most].forEach((level) => svg.append(
      make('path', {d: `M${bar + 11} ${(bottom - part(level) * high).toFixed(1)}h3`, stroke: colours.dim}),
      text(bar + 16, bottom - part(level) * high + 3.5, words(level), {fill: colours.dim, size: 10})));
    const marker = make('g', {class: 'now'});
    svg.append(marker);
    const mark = () => {
      const [a, b] = [present(across), present(up)];
      if (marker.value === `${a} ${b}`) return;
      marker.value = `${a} ${b}`;
      marker.replaceChildren();
      if (a === null || b === null) return;
      const [px, py] = [x(a), y(b)];
      marker.append(
        make('path', {d: `M${px} ${top}V${bottom}M${left} ${py}H${end}`, stroke: colours.now, 'stroke-dasharray': '2 3', opacity: 0.9}),
        make('circle', {cx: px, cy: py, r: 5, fill: 'none', stroke: '#fff', 'stroke-width': 4}),
        make('circle', {cx: px, cy: py, r: 5, fill: 'none', stroke: colours.now, 'stroke-width': 2.2}));
    };
    mark();
    return {svg, mark, x, y, left, end, top, bottom, high, size: [width, total]};
  };
  study.views.map = {
    empty: 'The map comes when you rest for a moment.',
    draw(body, data, width, height) {
      const drawn = figureMap(data, width, height, look(), isDark() ? RAMP.dark : RAMP.light), {svg} = drawn;
      const {figures, keys} = study.offer, keyList = keys.map(([key, label, group]) => [key, `${group}: ${label}`]);
      const readout = html('div', {className: 'readout', hidden: true});
      const lists = [
        picker('Another figure', [drawn.left, 0, 220, 20], figures.map(({name, label}) => [name, label]), data.figure.name, (of) => choose({of})),
        picker('Another parameter across', [drawn.left, drawn.bottom + 19, drawn.end - drawn.left, 18], keyList, data.x.key, (x) => choose({x})),
        picker('Another parameter upwards', [0, drawn.top + drawn.high / 2 - 60, 22, 120], keyList, data.y.key, (y) => choose({y})),
      ];
      const spot = (event) => {
        const box = svg.getBoundingClientRect(), zoom = box.width / drawn.size[0];
        const [px, py] = [(event.clientX - box.left) / zoom, (event.clientY - box.top) / zoom];
        if (px < drawn.left || px > drawn.end || py < drawn.top || py > drawn.bottom) return null;
        const [u, v] = [(px - drawn.left) / (drawn.end - drawn.left), (drawn.bottom - py) / drawn.high];
        return {
          px, py, a: snap(data.x, data.x.low + u * (data.x.high - data.x.low)), b: snap(data.y, data.y.low + v * (data.y.high - data.y.low)),
          value: between(data.values, u * (data.x.at.length - 1), v * (data.y.at.length - 1)),
        };
      };
      svg.addEventListener('click', (event) => {
        const found = spot(event);
        if (!found) return;
        tell('set', {[data.x.key]: found.a, [data.y.key]: found.b});
        [data.x.now, data.y.now] = [found.a, found.b];  // ahead of the server
        drawn.mark();
      });
      svg.addEventListener('pointermove', (event) => {
        const found = spot(event);
        readout.hidden = !found;
        svg.style.cursor = found ? 'crosshair' : '';
        if (!found) return;
        readout.textContent = `${words(found.a, 4)} ${data.x.unit}, ${words(found.b, 4)} ${data.y.unit}: `
          + (found.value === null ? 'no complete run' : `${words(found.value)} ${data.figure.unit}`);
        readout.style.top = `${Math.max(found.py - 30, 0)}px`;
        readout.style.left = `${Math.min(Math.max(found.px, 110), drawn.size[0] - 110)}px`;
      });
      svg.addEventListener('pointerleave', () => readout.hidden = true);
      body.replaceChildren(svg, ...lists, readout);
      return {mark: drawn.mark};
    },
    picture: (data) => figureMap(data, 760, 600, LIGHT, RAMP.light).svg,
    table: ({x, y, values, figure}) => [
      [x, y, figure].map(heading),
      ...values.flatMap((row, j) => row.map((value, i) => [inMetric(x.at[i], x), inMetric(y.at[j], y), inMetric(value, figure)])),
    ],
  };

  // ── Limits ──
  const limitPanels = (data, width, height, colours) => {
    const beside = width > 700, right = 14, left = 40, gap = 56, head = 24, foot = 40;
    const wide = beside ? (width - left - right - gap) / 2 : width - left - right;
    const high = Math.max(Math.min(beside ? height - head - foot : (height - 10) / 2 - head - foot, 0.9 * wide), 120);
    const total = (head + high + foot) * (beside ? 1 : 2);
    const svg = make('svg', {
      viewBox: `0 0 ${width} ${total}`, width, height: total, xmlns: 'http://www.w3.org/2000/svg', role: 'img',
      'aria-label': 'Ride-limited and shock-limited speeds',
    });
    const spots = [];
    const {speed: {unit: inSpeed}, size: {unit: inSize, metric: [, perMm]}} = data;
    [['ride', `Absorbed power reaches 6 W, ${inSpeed}`, `rms of the heights, ${inSize}, with the classes of ISO 8608`, true],
      ['shock', `Shock reaches 2.5 g, ${inSpeed}`, `height of the half-round, ${inSize}`, false]].forEach(([name, title, axis, powers], k) => {
      const start = left + (beside ? k * (wide + gap) : 0), end = start + wide;
      const top = head + (beside ? 0 : k * (head + high + foot)), bottom = top + high;
      const sizes = [...data.own[name], ...data.baseline[name]].map(({size}) => size);
      const turn = powers ? Math.log10 : (value) => value;
      const low = powers ? Math.min(2 * perMm, ...sizes) * 0.85 : 0, far = Math.max((powers ? 100 : 400) * perMm, ...sizes) * 1.06;
      const place = scale(start, end, turn(low), turn(far)), x = (size) => place(turn(size)), y = scale(bottom, top, 0, data.fastest * 1.06);
      svg.append(text(start, top - 8, title, {fill: colours.ink, weight: 600, size: 11.5}),
        make('rect', {x: start, y: top, width: wide, height: high, fill: 'none', stroke: colours.frame}));
      ticks(0, data.fastest, high / 36).forEach((tick) => svg.append(
        make('path', {d: `M${start} ${y(tick).toFixed(1)}H${end}`, stroke: colours.grid}),
        text(start - 6, y(tick) + 3.5, words(tick), {fill: colours.dim, anchor: 'end', size: 10})));
      (powers ? [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 200].filter((tick) => tick > low && tick < far) : ticks(0, far, wide / 60)).forEach((tick) => svg.append(
        make('path', {d: `M${x(tick).toFixed(1)} ${top}V${bottom}`, stroke: colours.grid}),
        text(x(tick), bottom + 14, words(tick), {fill: colours.dim, anchor: 'middle', size: 10})));
      svg.append(text((start + end) / 2, bottom + 31, axis, {fill: colours.ink, anchor: 'middle', weight: 500}));
      if (powers) data.own.ride.filter(({name: one}) => /^class .$/.test(one)).forEach(({name: one, size}) => svg.append(
        text(x(size), bottom - 6, one.slice(-1), {fill: colours.dim, anchor: 'middle', weight: 600})));
      [['baseline', {opacity: 0.6, 'stroke-dasharray': '4 3', 'stroke-width': 1.3}], ['own', {'stroke-width': 1.8}]].forEach(([whose, style]) => {
        const points = data[whose][name].filter(({size}) => size > 0), at_ = points.map(({size}) => size);
        svg.append(make('path', {
          d: area(at_, points.map(({low: one}) => one), points.map(({high: one}) => one), x, y), fill: colours.line,
          opacity: whose === 'own' ? 0.18 : 0.08,
        }), make('path', {d: path(at_, points.map(({speed}) => speed), x, y), fill: 'none', stroke: colours.line, ...style}));
        if (whose === 'own') points.filter(({speed}) => speed !== null).forEach((point) => {
          const [px, py] = [x(point.size).toFixed(1), y(point.speed).toFixed(1)];
          svg.append(point.never ? make('path', {d: `M${px} ${py - 5}l4.5 8h-9Z`, fill: colours.line})
            : make('circle', {cx: px, cy: py, r: 3, fill: point.again ? colours.back : colours.line, stroke: colours.line, 'stroke-width': 1.4}));
          spots.push({...point, x: Number(px), y: Number(py), axis: powers ? 'rms' : ''});
        });
      });
    });
    return {svg, spots, size: [width, total]};
  };
  study.views.limits = {
    empty: 'The fastest speeds come when you rest; all of them take half a minute.',
    draw(body, data, width, height) {
      const drawn = limitPanels(data, width, height - 40, look()), {svg, spots} = drawn;
      const readout = html('div', {className: 'readout', hidden: true});
      const note = html('p', {textContent: (data.done ? '' : `${Math.round(100 * data.part)} % of the grounds. `)
        + 'Triangles: never over the bound up to the highest speed tried. Rings: beyond it there is a speed that is below the bound again. '
        + 'Band: random roads of several seeds.'});
      svg.addEventListener('pointermove', (event) => {
        const box = svg.getBoundingClientRect(), zoom = box.width / drawn.size[0];
        const [px, py] = [(event.clientX - box.left) / zoom, (event.clientY - box.top) / zoom];
        const near = spots.reduce((best, one) => Math.hypot(one.x - px, one.y - py) < Math.hypot(best.x - px, best.y - py) ? one : best, {x: -99, y: -99});
        readout.hidden = Math.hypot(near.x - px, near.y - py) > 16;
        if (readout.hidden) return;
        readout.textContent = `${near.name}${near.axis ? `, ${words(near.size)} ${data.size.unit} rms` : ''}: ${near.never ? 'over ' : ''}${words(near.speed)} ${data.speed.unit}`;
        readout.style.top = `${Math.max(near.y - 30, 0)}px`;
        readout.style.left = `${Math.min(Math.max(near.x, 120), drawn.size[0] - 120)}px`;
      });
      svg.addEventListener('pointerleave', () => readout.hidden = true);
      body.replaceChildren(svg, note, readout);
    },
    picture: (data) => limitPanels(data, 1000, 460, LIGHT).svg,
    table: (data) => [['vehicle', 'limit', 'ground', 'size [mm]', 'speed [km/h]', 'slowest', 'fastest', 'note'],
      ...['own', 'baseline'].flatMap((whose) => ['ride', 'shock'].flatMap((name) => data[whose][name].map((one) =>
        [whose === 'own' ? 'now' : whose, name, one.name, inMetric(one.size, data.size),
          ...[one.speed, one.low, one.high].map((speed) => inMetric(speed, data.speed)),
          one.never ? 'never over the bound' : one.why || (one.again ? 'below the bound again beyond' : '')])))],
  };

  // ── Measured ──
  const NAMES = ['measured', 'simulated', 'fitted'];
  const measuredPanels = (data, width, height, colours) => {
    const left = 44, right = 12, head = 26, foot = 36, end = width - right;
    const high = Math.max((height - 2 * (head + foot)) / 2, 100), total = 2 * (head + high + foot);
    const inks = [colours.ink, colours.line, colours.now];
    const svg = make('svg', {viewBox: `0 0 ${width} ${total}`, width, height: total, xmlns: 'http://www.w3.org/2000/svg', role: 'img',
      'aria-label': `Measured and simulated acceleration, ${words(data.rms)} ${data.acceleration.unit} rms apart`});
    const span = (lists) => {
      const all = lists.flat().filter((value) => value !== null);
      return [Math.min(...all), Math.max(...all)];
    };
    const frame = (top, title, axis, [from, to], [low, high_]) => {
      const x = scale(left, end, from, to), y = scale(top + high, top, low, high_);
      svg.append(text(left, top - 9, title, {fill: colours.ink, weight: 600, size: 11.5}),
        make('rect', {x: left, y: top, width: end - left, height: high, fill: 'none', stroke: colours.frame}));
      ticks(low, high_, high / 32).forEach((tick) => svg.append(
        make('path', {d: `M${left} ${y(tick).toFixed(1)}H${end}`, stroke: colours.grid}),
        text(left - 6, y(tick) + 3.5, words(tick), {fill: colours.dim, anchor: 'end', size: 10})));
      ticks(from, to, (end - left) / 55).forEach((tick) => svg.append(
        make('path', {d: `M${x(tick).toFixed(1)} ${top + high}v4`, stroke: colours.frame}),
        text(x(tick), top + high + 15, words(tick, 4), {fill: colours.dim, anchor: 'middle', size: 10})));
      svg.append(text((left + end) / 2, top + high + 29, axis, {fill: colours.dim, anchor: 'middle'}));
      return [x, y];
    };
    const draw_ = ([x, y], lists) => lists.forEach(([xs, ys], k) => svg.append(make('path', {
      d: path(xs, ys, x, y), fill: 'none', stroke: inks[k], 'stroke-width': k === 0 ? 1.2 : 1.5, opacity: k === 0 ? 0.7 : 1,
      'stroke-linejoin': 'round',
    })));
    const [low, most] = span(data.curves), pad = 0.05 * (most - low || 1);
    draw_(frame(head, `Vertical acceleration, ${data.acceleration.unit}`, 'Time, s', [data.t[0], data.t.at(-1)], [low - pad, most + pad]),
      data.curves.map((ys) => [data.t, ys]));
    const top = 2 * head + high + foot, [, tallest] = span(data.spectra.map(({y}) => y));
    draw_(frame(top, `Its spectrum, ${data.acceleration.unit} rms in each band`, 'Frequency, Hz', [0, Math.max(...data.spectra.map(({x}) => x.at(-1)))], [0, 1.05 * tallest || 1]),
      data.spectra.map(({x, y}) => [x, y]));
    let place = end;
    data.curves.map((_, k) => k).reverse().forEach((k) => {
      svg.append(text(place, head - 9, NAMES[k], {fill: inks[k], anchor: 'end', weight: 600}));
      place -= widthOf(NAMES[k], 10.5, 600) + 12;
    });
    return {svg};
  };
  const upload = () => {
    const input = html('input', {type: 'file', accept: '.csv,.txt,.tsv', hidden: true});
    input.onchange = async () => {
      const [file] = input.files;
      if (file && file.size < 2e7) tell('record', {name: file.name, text: await file.text()});
    };
    return [input, button('Open a record…', 'A CSV file of time and vertical acceleration', () => input.click())];
  };
  const PASSES = [['', 'all frequencies'], ...[10, 20, 30, 50].map((hz) => [String(hz), `up to ${hz} Hz`])];
  study.views.measured = {
    always: true,
    empty: 'A record is a CSV file with a heading such as: t [s],a [m/s^2]. It is laid over the run that is shown, and '
      + 'parameters of your choice can be fitted to it.',
    draw(body, data, width, height) {
      if (!data.t) return void body.replaceChildren(html('p', {textContent: `${data.name}: ${data.said}.`}));
      const {fit, keys} = data, {fitted, low_pass} = study.choice;
      const {svg} = measuredPanels(data, width, height - (fit ? 130 : 80), look());
      const pass = html('select', {ariaLabel: 'Frequencies compared'}, ...options(PASSES, String(low_pass ?? '')));
      pass.onchange = () => choose({low_pass: pass.value ? Number(pass.value) : null});
      const chips = fitted.map((key) => button(`${keys.find(([one]) => one === key)?.[1] ?? key} ✕`, 'Do not fit this one',
        () => choose({fitted: fitted.filter((one) => one !== key)})));
      const add = html('select', {ariaLabel: 'Fit a parameter'}, html('option', {value: '', textContent: '+ parameter'}), ...options(keys));
      add.onchange = () => add.value && !fitted.includes(add.value) && choose({fitted: [...fitted, add.value].slice(-4)});
      const go = button('Fit', 'Find the values that come nearest to the record', () => choose({fit: study.choice.fit + 1}));
      go.disabled = !fitted.length || Boolean(data.busy);
      go.className = 'main';
      const line = html('p', {className: 'line'}, html('b', {textContent: `${words(data.rms)} ${data.acceleration.unit}`}),
        ` rms apart · the run begins at ${words(data.lag)} s of the record · offset ${words(data.offset)} ${data.acceleration.unit}`);
      const tools = html('div', {className: 'tools row'}, pass, ...chips, add, go, html('span', {textContent: data.busy || data.said}));
      const parts = [line, svg, tools];
      if (fit) parts.push(html('p', {className: 'line'},
        `Fitted: ${words(fit.rms)} ${data.acceleration.unit} rms apart. `, ...fit.rows.map((row) => html('span', {},
          `${row.label} `, html('b', {textContent: `${words(row.value, 4)} ${row.unit}`}),
          ` (${words(row.low)} … ${words(row.high)}${row.end ? ', at the end of its range' : ''}) `)),
        button('Apply', 'Give the parameters these values', () =>
          tell('set', Object.fromEntries(fit.rows.map((row) => [row.key, row.value])))),
      ));
      body.replaceChildren(...parts);
    },
    more: upload,
    picture: (data) => measuredPanels(data, 900, 620, LIGHT).svg,
    table: (data) => [['t [s]', ...data.curves.map((_, k) => `${NAMES[k]} [m/s^2]`)],
      ...data.t.map((time, k) => [time, ...data.curves.map((ys) => inMetric(ys[k], data.acceleration))])],
  };

  // ── The tab ──
  const save = (name, type, content) => {  // this script runs in a picture's handler, where URL is the document's address
    const link = html('a', {download: name, href: window.URL.createObjectURL(new Blob([content], {type}))});
    link.click();
    setTimeout(() => window.URL.revokeObjectURL(link.href), 10_000);
  };
  const svgText = (svg) => {
    const {width, height} = svg.viewBox.baseVal;
    svg.prepend(make('rect', {width, height, fill: LIGHT.back}));
    return new XMLSerializer().serializeToString(svg);
  };
  const exported = {
    SVG: (view, data, name) => save(`${name}.svg`, 'image/svg+xml', svgText(view.picture(data))),
    PNG: (view, data, name) => {
      const svg = view.picture(data), {width, height} = svg.viewBox.baseVal, image = new Image();
      image.onload = () => {
        const canvas = html('canvas', {width: 2 * width, height: 2 * height});
        canvas.getContext('2d').drawImage(image, 0, 0, 2 * width, 2 * height);
        canvas.toBlob((blob) => save(`${name}.png`, 'image/png', blob));
      };
      image.src = `data:image/svg+xml;charset=utf-8,${encodeURIComponent(svgText(svg))}`;
    },
    CSV: (view, data, name) => {
      const cell = (value) => value === null || value === undefined ? '' : /[",]/.test(value) ? `"${value}"` : value;
      save(`${name}.csv`, 'text/csv', view.table(data).map((row) => row.map(cell).join()).join('\n') + '\n');
    },
  };
  const button = (name, hint, act, pressed) => {
    const it = html('button', {type: 'button', textContent: name, title: hint, onclick: act});
    if (pressed !== undefined) it.ariaPressed = String(pressed);
    return it;
  };
  let drawn = null;  // what the view gave that is drawn
  const enlarge = (on) => {
    study.large = on;
    draw();
  };
  const fill = () => {  // over the 3-D view and the plots, beside the parameters
    const panel = document.querySelector('[data-trackride="panel"]')?.getBoundingClientRect();
    const docked = panel && panel.right < innerWidth / 2 && panel.height > innerHeight / 2;
    const left = docked ? Math.ceil(panel.right) + 6 : 0;
    Object.assign(study.page.style, {left: `${left}px`, width: `${innerWidth - left}px`});
    return [innerWidth - left - 32, innerHeight - 74];
  };
  const draw = () => {
    const page = study.page;
    if (!page?.isConnected) return;
    if (drawn?.held?.() || study.picking) return void (study.due = true);  // not under the user's hand
    if (study.large !== page.matches(':popover-open')) study.large ? page.showPopover() : page.hidePopover();
    page.classList.toggle('large', study.large);
    if (!study.large) page.removeAttribute('style');
    if (!page.offsetWidth) return;
    const {view: name} = study.choice, view = study.views[name], data = study.data[name];
    let [width, height] = study.large ? fill() : [page.clientWidth - 20, innerHeight - page.getBoundingClientRect().top - 88];
    [width, height] = [Math.max(width, 260), Math.max(height, 240)];
    keepingFocus(page, () => build(page, view, name, data, width, height));
  };
  const build = (page, view, name, data, width, height) => {
    const open = page.querySelector('details')?.open ?? false;
    const head = html('div', {className: 'head'},
      html('div', {className: 'views'}, ...Object.entries(VIEWS).filter(([one]) => study.views[one]).map(([one, label]) =>
        button(label, '', () => choose({view: one}), one === name))),
      html('div', {className: 'tools'}, ...(data || view.always ? (view.more?.(data) ?? []) : []),
        ...(data && (data.t || name !== 'measured') ? Object.entries(exported).map(([kind, act]) =>
          button(kind, `Save as ${kind}`, () => act(view, data, `trackride-${name}`))) : []),
        button(study.large ? '✕' : '⤢', study.large ? 'Back to the tab (Esc)' : 'Large, over the view', () => enlarge(!study.large))));
    const body = html('div', {className: 'body'});
    page.replaceChildren(head, body);
    drawn = null;
    if (data) drawn = view.draw(body, data, width, height) ?? null;
    else body.append(html('p', {textContent: view.empty}));
    if (data?.commands?.length) {
      const lines = [...(data.note ? [`# ${data.note}`] : []), ...data.commands].join('\n');
      const copy = button('Copy', 'Copy these lines', () => navigator.clipboard?.writeText(lines));
      page.append(html('details', {open}, html('summary', {textContent: 'The same on the command line'}), copy,
        html('pre', {textContent: lines})));
    }
  };

  // ── On the sliders ──
  const STRIP = 'trackride-strip';
  const strips = () => {
    const data = study.choice.strips ? study.data.profiler : null;
    const place = data ? data.figures.findIndex(({name}) => name === study.choice.figure) : -1;
    const all = place < 0 ? [] : data.columns.filter(({key}) => study.sliders[key])
      .flatMap(({y}) => y[place].filter((value) => value !== null));
    const most = Math.max(...all, 0), least = Math.min(...all, most);
    for (const [key, id] of Object.entries(study.sliders ?? {})) {
      const root = document.getElementById(id)?.querySelector('.mantine-Slider-trackContainer, .mantine-Slider-track')
        ?.closest('.mantine-Slider-root') ?? document.getElementById(id);
      if (!root) continue;
      const column = place < 0 ? null : data.columns.find((one) => one.key === key);
      let strip = root.querySelector(`.${STRIP}`);
      if (!column || !all.length || most === least) { strip?.remove(); continue; }
      if (!strip) root.append(strip = html('div', {className: STRIP}));
      const thumb = root.querySelector('[role="slider"]');
      const [low, high] = [Number(thumb.ariaValueMin), Number(thumb.ariaValueMax)];
      const x = scale(0, 100, low, high), y = scale(100, 8, least, most);
      const line = path(column.x, column.y[place], x, y);
      if (strip.line === line) continue;
      strip.line = line;
      const known = column.x.filter((_, k) => column.y[place][k] !== null);
      const under = `${line}L${x(known.at(-1)).toFixed(1)} 100L${x(known[0]).toFixed(1)} 100Z`;
      strip.replaceChildren(make('svg', {viewBox: '0 0 100 100', preserveAspectRatio: 'none'},
        make('path', {d: under, class: 'under'}), make('path', {d: line, class: 'line', 'vector-effect': 'non-scaling-stroke'})));
    }
  };
  const matters = () => document.querySelectorAll('trackride-matters').forEach((line) => {
    if (!study.offer) return;
    const {strips: on, figure} = study.choice, data = study.data.profiler;
    const chosen = data?.figures.find(({name}) => name === figure) ?? data?.figures.find(({name}) => name === data.figure);
    const list = html('select', {ariaLabel: 'Figure on the sliders', title: 'Another figure'},
      ...options(study.offer.figures.map(({name, label}) => [name, label]), figure));
    list.onchange = () => choose({figure: list.value});
    const names = (chosen?.effects ?? []).slice(0, chosen?.decisive).map(([key]) =>
      data.columns.find((column) => column.key === key).label.toLowerCase());
    const last = names.pop(), what = names.length ? `${names.join(', ')} and ${last}` : last;
    const told = html('span', {textContent: !on ? '' : !chosen ? '…' : last ? `: mostly ${what}` : ': nothing changes it'});
    const toggle = html('input', {type: 'checkbox', checked: on, ariaLabel: 'What each slider would do',
      title: 'Show on each slider how this figure changes along it', onchange: () => choose({strips: toggle.checked})});
    keepingFocus(line, () => line.replaceChildren(toggle, html('div', {}, list, told)));
    line.title = told.textContent.slice(2);
  });

  study.take = (kind, data) => {
    study.data[kind] = data;
    if (kind === study.choice.view) draw();
    if (kind === 'profiler') { strips(); matters(); }
  };
  const taken = {};  // text of the newest data of each kind: the profiler's stand in both panels
  customElements.define('trackride-study-data', class extends HTMLElement {
    connectedCallback() {
      const kind = this.getAttribute('of'), text = this.getAttribute('at');
      if (taken[kind] !== text) study.take(kind, JSON.parse(taken[kind] = text));
    }
  });
  let opened = '0';  // count of the newest choice that a project has brought
  customElements.define('trackride-study-choice', class extends HTMLElement {
    connectedCallback() {
      if (this.getAttribute('count') === opened) return;  // viser has drawn the page anew
      opened = this.getAttribute('count');
      choose(JSON.parse(this.getAttribute('at')));
    }
  });
  const hideBoxes = () => sayBoxes().forEach((box) => { box.style.display = 'none'; });
  const hide = () => {
    hideBoxes();
    requestAnimationFrame(hideBoxes);
  };
  customElements.define('trackride-matters', class extends HTMLElement {
    connectedCallback() {
      study.sliders = JSON.parse(this.dataset.sliders);
      study.offer = JSON.parse(this.dataset.offer);
      let kept = {};
      try { kept = JSON.parse(localStorage.getItem(KEPT)) ?? {}; } catch { /* not ours */ }
      study.choice = {...study.offer.choice, ...kept, fit: 0};
      if (!study.views[study.choice.view]) study.choice.view = 'profiler';
      hide();
      tell('choice', study.choice);
      matters();
      draw();
    }
  });
  let size = '';
  const resized = new ResizeObserver(() => {
    const now = `${study.page.offsetWidth} ${innerHeight} ${isDark()}`;
    if (now !== size) { size = now; draw(); }
  });
  customElements.define('trackride-study', class extends HTMLElement {
    connectedCallback() {
      study.page = this;
      this.popover = 'manual';
      hide();
      resized.observe(this);
      draw();
    }
  });
  new MutationObserver(() => { draw(); strips(); }).observe(document.documentElement,
    {attributes: true, attributeFilter: ['data-mantine-color-scheme']});
  window.addEventListener('resize', () => draw());
  document.addEventListener('keydown', (event) => {
    if (event.key === 'Escape' && study.large) enlarge(false);
  });
  const lists = 'trackride-study select';
  document.addEventListener('pointerdown', ({target}) => study.picking = Boolean(target.closest?.(lists)), true);
  for (const end of ['change', 'focusout', 'keydown'])
    document.addEventListener(end, ({target}) => { if (target.closest?.(lists)) study.picking = false; }, true);
  setInterval(() => {
    drawn?.mark?.();
    const columns = study.choice.view === 'profiler' ? study.data.profiler?.columns ?? [] : [];
    study.page?.querySelector('.body')?.classList.toggle('stale', columns.some((one) => present(one) !== one.now));
    if (study.due && !drawn?.held?.() && !study.picking) { study.due = false; draw(); }
    strips();
  }, 150);
}
