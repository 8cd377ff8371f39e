// A canvas with axes, sharp on any screen, in the colours of the style sheet.

const MARGIN = { left: 46, right: 10, top: 8, bottom: 30 };

/** Round numbers between two ends, about `wanted` of them. */
export function ticks(low, high, wanted) {
  const rough = (high - low) / wanted;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((factor) => factor * power).find((size) => size >= rough);
  const numbers = [];
  for (let index = Math.ceil(low / step - 1e-9); index * step <= high + 1e-9 * step; index += 1) {
    numbers.push(index * step);
  }
  const digits = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
  return numbers.map((value) => ({ value, text: value.toFixed(digits).replace("-", "−") }));
}

/** A colour of the style sheet. */
export function colour(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
}

/** Clears a canvas; its pen and its size in CSS pixels. */
export function cleared(canvas) {
  const ratio = window.devicePixelRatio || 1;
  const { width, height } = canvas.getBoundingClientRect();
  const [wide, high] = [Math.round(width * ratio), Math.round(height * ratio)];
  if (canvas.width !== wide || canvas.height !== high) {
    canvas.width = wide;
    canvas.height = high;
  }
  const pen = canvas.getContext("2d");
  pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  pen.clearRect(0, 0, width, height);
  pen.font = "11px system-ui, sans-serif";
  return { pen, width, height };
}

export class Plot {
  /** `x` and `y` are the ends of the axes. */
  constructor(canvas, { x, y, xLabel, yLabel }) {
    Object.assign(this, cleared(canvas), { x, y });
    this.right = this.width - MARGIN.right;
    this.bottom = this.height - (xLabel === undefined ? 6 : MARGIN.bottom);
    this.axes(xLabel, yLabel);
  }

  atX(value) {
    return MARGIN.left + ((value - this.x[0]) / (this.x[1] - this.x[0])) * (this.right - MARGIN.left);
  }

  atY(value) {
    return this.bottom - ((value - this.y[0]) / (this.y[1] - this.y[0])) * (this.bottom - MARGIN.top);
  }

  axes(xLabel, yLabel) {
    const { pen } = this;
    pen.strokeStyle = colour("line");
    pen.fillStyle = colour("faint");
    pen.lineWidth = 1;
    pen.textAlign = "right";
    pen.textBaseline = "middle";
    for (const { value, text } of ticks(this.y[0], this.y[1], (this.bottom - MARGIN.top) / 34)) {
      this.rule(MARGIN.left, this.atY(value), this.right, this.atY(value));
      pen.fillText(text, MARGIN.left - 5, this.atY(value));
    }
    if (xLabel !== undefined) {
      this.xAxis(xLabel);
    }
    pen.save();
    pen.translate(9, (MARGIN.top + this.bottom) / 2);
    pen.rotate(-Math.PI / 2);
    pen.textAlign = "center";
    pen.fillText(yLabel, 0, 0);
    pen.restore();
  }

  xAxis(label) {
    const { pen } = this;
    pen.textAlign = "center";
    pen.textBaseline = "top";
    for (const { value, text } of ticks(this.x[0], this.x[1], (this.right - MARGIN.left) / 60)) {
      this.rule(this.atX(value), this.bottom, this.atX(value), this.bottom + 3);
      pen.fillText(text, this.atX(value), this.bottom + 4);
    }
    pen.fillText(label, (MARGIN.left + this.right) / 2, this.bottom + 17);
  }

  rule(x1, y1, x2, y2) {
    this.pen.beginPath();
    this.pen.moveTo(x1, y1);
    this.pen.lineTo(x2, y2);
    this.pen.stroke();
  }

  /** Draws within the axes alone. */
  within(draw) {
    const { pen } = this;
    pen.save();
    pen.beginPath();
    pen.rect(MARGIN.left, MARGIN.top, this.right - MARGIN.left, this.bottom - MARGIN.top);
    pen.clip();
    draw(pen);
    pen.restore();
  }

  /** A line through points `[x, y]`; a `null` breaks it. */
  line(points, name, width = 1.5) {
    this.within((pen) => {
      pen.strokeStyle = colour(name);
      pen.lineWidth = width;
      pen.beginPath();
      let down = false;
      for (const [x, y] of points) {
        if (y === null) {
          down = false;
          continue;
        }
        const place = [this.atX(x), this.atY(y)];
        down ? pen.lineTo(...place) : pen.moveTo(...place);
        down = true;
      }
      pen.stroke();
    });
  }

  /** The area between `[x, low, high]`. */
  band(points, name, opacity) {
    if (points.length === 0) {
      return;
    }
    this.within((pen) => {
      pen.fillStyle = colour(name);
      pen.globalAlpha = opacity;
      pen.beginPath();
      points.forEach(([x, low]) => pen.lineTo(this.atX(x), this.atY(low)));
      [...points].reverse().forEach(([x, , high]) => pen.lineTo(this.atX(x), this.atY(high)));
      pen.fill();
    });
  }

  /** A dot. */
  dot(x, y, name, radius, opacity = 1) {
    this.within((pen) => {
      pen.fillStyle = colour(name);
      pen.globalAlpha = opacity;
      pen.beginPath();
      pen.arc(this.atX(x), this.atY(y), radius, 0, 2 * Math.PI);
      pen.fill();
    });
  }

  /** An upright line over the whole height. */
  upright(x, name) {
    this.within((pen) => {
      pen.strokeStyle = colour(name);
      pen.setLineDash([4, 3]);
      this.rule(this.atX(x), MARGIN.top, this.atX(x), this.bottom);
    });
  }
}
