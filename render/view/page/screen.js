// screen.js - the canvas: pictures at device pixels, small ones scaled up smoothly, the final one as it is.

export class Screen {
  constructor(canvas, resized) {
    this.canvas = canvas;
    this.context = canvas.getContext("2d", {alpha: true});
    this.bitmap = null;
    this.head = null;
    this.observer = new ResizeObserver(entries => {
      const e = entries[entries.length - 1], ratio = window.devicePixelRatio || 1;
      const box = e.devicePixelContentBoxSize?.[0];
      const width = Math.max(1, box ? box.inlineSize : Math.round(e.contentRect.width * ratio));
      const height = Math.max(1, box ? box.blockSize : Math.round(e.contentRect.height * ratio));
      if (width === canvas.width && height === canvas.height) return;
      canvas.width = width;
      canvas.height = height;
      this.paint();
      resized();
    });
    try {
      this.observer.observe(canvas, {box: "device-pixel-content-box"});
    } catch {
      this.observer.observe(canvas);
    }
  }

  get width() { return this.canvas.width; }
  get height() { return this.canvas.height; }

  show(head, bitmap) {
    this.bitmap?.close();
    this.bitmap = bitmap;
    this.head = head;
    this.paint();
  }

  paint() {
    const b = this.bitmap, c = this.context, {width, height} = this.canvas;
    if (!b) return;
    const same = b.width === width && b.height === height;
    this.canvas.classList.toggle("crisp", same);
    c.globalCompositeOperation = "copy";
    c.imageSmoothingEnabled = !same;
    c.imageSmoothingQuality = "high";
    c.drawImage(b, 0, 0, width, height);
  }

  // Of the page's coordinates, in pixels of the picture.
  pixel(event) {
    const box = this.canvas.getBoundingClientRect();
    return [(event.clientX - box.left) * this.width / box.width, (event.clientY - box.top) * this.height / box.height];
  }
}
