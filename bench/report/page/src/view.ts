// Drawing only what can be seen, once a frame: a report of a hundred runs has more plots than a screen.

const FRAME = 30; // [ms] of drawing in one frame
const views = new Set<View>();
let scheduled = false;

function schedule(): void {
  if (scheduled) return;
  scheduled = true;
  requestAnimationFrame(() => {
    scheduled = false;
    // A frame at a time, from the top of the page: the first pictures do not wait for the last ones.
    const end = performance.now() + FRAME;
    for (const view of views) {
      if (view.drawIfNeeded() && performance.now() > end) {
        schedule();
        return;
      }
    }
  });
}

const observer = new IntersectionObserver(
  (entries) => {
    for (const entry of entries) {
      for (const view of views) if (view.element === entry.target) view.visible = entry.isIntersecting;
    }
    schedule();
  },
  { rootMargin: "150px" },
);

const resizes = new ResizeObserver((entries) => {
  for (const entry of entries) {
    for (const view of views) if (view.element === entry.target) view.resized();
  }
});

export class View {
  visible = false;
  private needed = true;
  private width = -1;

  /// `draw` is called when the element is on the screen and has been invalidated, or has another width.
  constructor(
    readonly element: HTMLElement,
    private readonly draw: () => void,
  ) {
    views.add(this);
    observer.observe(element);
    resizes.observe(element);
  }

  invalidate(): void {
    this.needed = true;
    schedule();
  }

  resized(): void {
    const width = this.element.clientWidth;
    if (width === this.width) return;
    this.width = width;
    this.invalidate();
  }

  /// Whether it was drawn.
  drawIfNeeded(always = false): boolean {
    if (!this.needed || !(this.visible || always)) return false;
    this.needed = false;
    this.draw();
    return true;
  }
}

/// Draws everything, seen or not: for print, and before a picture is saved.
export function drawAll(): void {
  for (const view of views) view.drawIfNeeded(true);
}

/// Whether nothing that can be seen waits to be drawn: for tests of the page.
export function isIdle(): boolean {
  return !scheduled;
}
