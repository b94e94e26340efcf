// The trajectory in 3D: estimates, ground truth, landmarks, control states, losses, and the camera at the time of the
// cursor. It is drawn when something changes, not all the time.
import {
  BufferGeometry,
  Group,
  LineBasicMaterial,
  LineSegments,
  PerspectiveCamera,
  Points,
  PointsMaterial,
  Quaternion,
  Scene,
  Vector3,
  WebGLRenderer,
  type Material,
  type Object3D,
} from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { Line2 } from "three/examples/jsm/lines/Line2.js";
import { LineGeometry } from "three/examples/jsm/lines/LineGeometry.js";
import { LineMaterial } from "three/examples/jsm/lines/LineMaterial.js";
import type { Run, Trajectory } from "./data";
import { lastUpTo, numbers, orientationAt, valueAt, vectorAt } from "./decode";
import { button, element, format } from "./dom";
import { fileName, saveBlob } from "./download";
import { geometryOf, points, roundLength, stretches } from "./scene_geometry";
import { lossesOf } from "./sides";
import type { State } from "./state";
import { colourOf, colours } from "./theme";
import { timeKeys } from "./time_chart";
import { estimatesOf } from "./time_plots";
import { View } from "./view";

const FRUSTUM = 0.1; // depth of the camera's pyramid, of the size of the trajectory
const LANDMARK_SHARE = 0.95; // of the landmarks are in the first view: some are very far away

/// A part of a trajectory that grows with time: a strong line up to the cursor, a faint one of all.
interface Growing {
  line: Line2;
  times: Float64Array; // of its points
}

interface CameraMark {
  pyramid: LineSegments;
  trajectories: Trajectory[];
}

class SceneView {
  readonly element: HTMLElement;
  private readonly stage = element("div", {
    class: "stage",
    tabindex: 0,
    role: "application",
    "aria-label": "Trajectory in 3D. Arrow keys turn the view, plus and minus zoom, comma and full stop move the time.",
  });
  private readonly scaleBar = element("div", { class: "scale-bar" });
  private readonly axisNames = ["x", "y", "z"].map((name) => element("span", { class: "axis-name" }, name));
  private readonly readout = element("div", { class: "readout" });
  private readonly message = element("p", { class: "empty", hidden: true });
  private readonly view: View;
  private renderer: WebGLRenderer | null = null;
  private controls: OrbitControls | null = null;
  private readonly scene = new Scene();
  private readonly camera = new PerspectiveCamera(45, 1, 0.01, 1000);
  private readonly content = new Group();
  private growing: Growing[] = [];
  private marks: CameraMark[] = [];
  private size = 1; // [m] of the trajectories
  private readonly centre = new Vector3(); // of the box around the trajectories, from `least` to `most`
  private readonly least = new Vector3();
  private readonly most = new Vector3();
  private shownSequence = -1;
  private built = false;
  private readonly show = { landmarks: true, states: true, truth: true };

  constructor(private readonly state: State) {
    this.stage.append(this.scaleBar, ...this.axisNames);
    const toggle = (name: keyof typeof this.show, label: string): HTMLElement =>
      element(
        "label",
        {},
        element("input", {
          type: "checkbox",
          checked: this.show[name],
          onchange: (event: Event) => {
            this.show[name] = (event.target as HTMLInputElement).checked;
            this.rebuild();
          },
        }),
        ` ${label}`,
      );
    this.element = element(
      "figure",
      { class: "chart scene" },
      element(
        "div",
        { class: "chart-head" },
        element("h3", {}, "In 3D"),
        element(
          "span",
          { class: "tools" },
          toggle("truth", "ground truth"),
          toggle("landmarks", "landmarks"),
          toggle("states", "control states"),
          button("xy", "Look along z", () => this.lookAlong(0, 0, 1)),
          button("xz", "Look along y", () => this.lookAlong(0, -1, 0.001)),
          button("yz", "Look along x", () => this.lookAlong(1, 0, 0.001)),
          button("fit", "Whole trajectory", () => this.lookAlong(0.6, -0.8, 0.55)),
        ),
        element("span", { class: "save" }, button("PNG", "Save the view as PNG", () => this.save())),
      ),
      this.stage,
      this.message,
      this.readout,
    );
    this.stage.addEventListener("keydown", (event) => this.keys(event));
    this.view = new View(this.element, () => this.draw());
    for (const topic of ["selection", "theme", "estimate"] as const) state.on(topic, () => this.rebuild());
    state.on("time", () => this.view.invalidate());
  }

  private rebuild(): void {
    this.built = false;
    this.view.invalidate();
  }

  /// False where the browser has no WebGL: the views from three sides show the same.
  private start(): boolean {
    if (this.renderer) return true;
    if (!this.message.hidden) return false;
    try {
      this.renderer = new WebGLRenderer({ antialias: true, alpha: true, preserveDrawingBuffer: true });
    } catch {
      this.stage.hidden = true;
      this.message.hidden = false;
      this.message.textContent = "This browser has no WebGL; the views from three sides show the same.";
      return false;
    }
    this.renderer.debug.checkShaderErrors = false; // it waits for the compiler
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.stage.prepend(this.renderer.domElement);
    this.scene.add(this.content);
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, this.renderer.domElement);
    this.controls.enableDamping = false;
    this.controls.addEventListener("change", () => this.view.invalidate());
    return true;
  }

  private draw(): void {
    if (!this.start()) {
      this.write();
      return;
    }
    const [width, height] = [this.stage.clientWidth, this.stage.clientHeight];
    if (width === 0 || height === 0 || !this.renderer) return;
    const size = this.renderer.getSize(this.viewport);
    if (size.x !== width || size.y !== height) {
      this.renderer.setSize(width, height);
      this.camera.aspect = width / height;
      this.camera.updateProjectionMatrix();
      this.built = false;
    }
    if (!this.built) this.build();
    this.setTime();
    this.renderer.render(this.scene, this.camera);
    this.drawScale(width, height);
    this.write();
  }
  private readonly viewport = new Vector3() as unknown as Parameters<WebGLRenderer["getSize"]>[0];

  private clear(): void {
    const dispose = (object: Object3D): void => {
      (object as { geometry?: BufferGeometry }).geometry?.dispose();
    };
    this.content.traverse(dispose);
    this.content.clear();
    this.growing = [];
    this.marks = [];
  }

  /// Materials are kept: with the last one of a kind its shaders would go, and compiling them again takes long.
  private material<T extends Material>(name: string, make: () => T): T {
    const known = this.materials.get(name);
    if (known) return known as T;
    const material = make();
    this.materials.set(name, material);
    return material;
  }
  private readonly materials = new Map<string, Material>();

  private line(p: Float32Array, colour: string, width: number, opacity: number, dashes = 0): Line2 {
    const geometry = new LineGeometry();
    geometry.setPositions(p);
    const material = this.material(`line ${colour} ${width} ${opacity} ${dashes > 0}`, () => {
      return new LineMaterial({ color: colour, linewidth: width, transparent: opacity < 1, opacity, dashed: dashes > 0 });
    });
    material.resolution.set(this.stage.clientWidth, this.stage.clientHeight);
    material.dashSize = dashes;
    material.gapSize = dashes;
    const line = new Line2(geometry, material);
    if (dashes > 0) line.computeLineDistances();
    this.content.add(line);
    return line;
  }

  private build(): void {
    this.built = true;
    this.clear();
    const { state } = this;
    const of = colours();
    const truth = state.sequence?.ground_truth ?? null;
    const runs = state.shown.flatMap((index) => {
      const run = state.payload.runs[index];
      return run ? [{ run, index, colour: colourOf(state.slot(index), of) }] : [];
    });
    this.measure([...runs.flatMap(({ run }) => estimatesOf(run, state.estimate).map(({ estimate }) => estimate)), ...(truth ? [truth] : [])]);
    if (truth && this.show.truth) {
      for (const { p } of stretches(truth)) this.line(p, of.truth, 1.3, 0.85, 0.012 * this.size);
    }
    for (const { run, index, colour } of runs) this.addRun(run, index === state.focus, colour, of.faint);
    for (const { p } of lossesOf(state)) this.addCross(p, of.warn);
    this.addAxes();
    if (state.run?.sequence !== this.shownSequence) {
      this.shownSequence = state.run?.sequence ?? -1;
      this.lookAlong(0.6, -0.8, 0.55);
    }
  }

  private addRun(run: Run, focused: boolean, colour: string, landmarks: string): void {
    const estimates = estimatesOf(run, this.state.estimate);
    for (const { estimate, scored } of estimates) {
      for (const { t, p } of stretches(estimate)) {
        this.line(p, colour, 1.2, 0.35);
        this.growing.push({ line: this.line(p, colour, focused ? 2.6 : 1.8, 1, scored ? 0 : 0.006 * this.size), times: t });
      }
    }
    const pyramid = this.pyramid(colour);
    this.content.add(pyramid);
    this.marks.push({ pyramid, trajectories: estimates.map(({ estimate }) => estimate) });
    if (!focused) return;
    if (this.show.landmarks) {
      for (const segment of run.segments) this.content.add(this.cloud(points(segment.landmarks), landmarks, 2.2, 0.8));
    }
    if (this.show.states && run.control_times) this.content.add(this.cloud(this.statePoints(run), colours().text, 2.2));
  }

  private cloud(values: Float32Array, colour: string, size: number, opacity = 1): Points {
    const material = this.material(`points ${colour} ${size} ${opacity}`, () => {
      return new PointsMaterial({ color: colour, size, sizeAttenuation: false, transparent: opacity < 1, opacity });
    });
    return new Points(geometryOf(values), material);
  }

  private statePoints(run: Run): Float32Array {
    const values: number[] = [];
    if (!run.control_times) return new Float32Array();
    for (const { estimate } of estimatesOf(run, this.state.estimate)) {
      const t = numbers(estimate.t);
      for (const time of numbers(run.control_times)) {
        const p = vectorAt(t, estimate.p, time);
        if (p.every((value) => Number.isFinite(value))) values.push(...p);
      }
    }
    return Float32Array.from(values);
  }

  /// The camera: its centre, the corners of its image, and a triangle on the image's upper side. y points down.
  private pyramid(colour: string): LineSegments {
    const depth = FRUSTUM * this.size;
    const [left, right, top, bottom] = [-0.6, 0.6, -0.45, 0.45]; // a usual field of view: runs do not keep their camera
    const corners = [
      [left * depth, top * depth, depth],
      [right * depth, top * depth, depth],
      [right * depth, bottom * depth, depth],
      [left * depth, bottom * depth, depth],
    ];
    const values: number[] = [];
    corners.forEach((corner, i) => values.push(0, 0, 0, ...corner, ...corner, ...(corners[(i + 1) % 4] ?? corner)));
    const tip = [(0.5 * (left + right)) * depth, (top - 0.25 * (bottom - top)) * depth, depth];
    values.push(...(corners[0] ?? tip), ...tip, ...tip, ...(corners[1] ?? tip));
    const material = this.material(`segments ${colour}`, () => new LineBasicMaterial({ color: colour }));
    return new LineSegments(geometryOf(Float32Array.from(values)), material);
  }

  private addCross(p: [number, number, number], colour: string): void {
    const half = 0.025 * this.size;
    const values: number[] = [];
    for (const [a, b, c] of [[1, 1, 1], [1, -1, 1], [1, 1, -1], [1, -1, -1]] as const) {
      values.push(p[0] - half * a, p[1] - half * b, p[2] - half * c, p[0] + half * a, p[1] + half * b, p[2] + half * c);
    }
    for (let i = 0; i < values.length; i += 6) this.line(Float32Array.from(values.slice(i, i + 6)), colour, 3, 1);
  }

  /// Axes of the world at its origin, named by letters.
  private addAxes(): void {
    const of = colours();
    const length = 0.15 * this.size;
    this.axisEnds.forEach((end, axis) => {
      end.set(0, 0, 0).setComponent(axis, length);
      this.line(Float32Array.from([0, 0, 0, ...end.toArray()]), of.faint, 1.5, 1);
      end.multiplyScalar(1.15);
    });
  }
  private readonly axisEnds = [new Vector3(), new Vector3(), new Vector3()];

  private measure(trajectories: Trajectory[]): void {
    const least = new Vector3(Infinity, Infinity, Infinity);
    const most = new Vector3(-Infinity, -Infinity, -Infinity);
    for (const { p } of trajectories) {
      const values = points(p);
      for (let i = 0; i + 2 < values.length; i += 3) {
        const at = new Vector3(values[i], values[i + 1], values[i + 2]);
        least.min(at);
        most.max(at);
      }
    }
    const known = most.x >= least.x;
    this.size = known ? Math.max(most.distanceTo(least), 1e-6) : 1;
    this.least.copy(known ? least : new Vector3(-0.5, -0.5, -0.5));
    this.most.copy(known ? most : new Vector3(0.5, 0.5, 0.5));
    this.centre.addVectors(this.least, this.most).multiplyScalar(0.5);
  }

  /// Centre and radius of the view: the trajectory and most landmarks, unless these are much farther away.
  private frame(): { centre: Vector3; radius: number } {
    const least = this.least.clone();
    const most = this.most.clone();
    const landmarks = this.show.landmarks ? (this.state.run?.segments ?? []).map((segment) => points(segment.landmarks)) : [];
    for (let axis = 0; axis < 3; ++axis) {
      const values = landmarks.flatMap((list) => [...list.filter((_, i) => i % 3 === axis)]).sort((a, b) => a - b);
      const at = (share: number): number => values[Math.round(share * (values.length - 1))] ?? this.centre.getComponent(axis);
      const far = 1.1 * this.size;
      const middle = this.centre.getComponent(axis);
      least.setComponent(axis, Math.max(middle - far, Math.min(least.getComponent(axis), at(1 - LANDMARK_SHARE))));
      most.setComponent(axis, Math.min(middle + far, Math.max(most.getComponent(axis), at(LANDMARK_SHARE))));
    }
    const centre = least.clone().add(most).multiplyScalar(0.5);
    return { centre, radius: 0.5 * Math.max(least.distanceTo(most), 1e-6) };
  }

  private lookAlong(x: number, y: number, z: number): void {
    if (!this.controls) return;
    const { centre, radius } = this.frame();
    const half = Math.sin((0.5 * this.camera.fov * Math.PI) / 180);
    const distance = (0.95 * radius) / (half * Math.min(1, this.camera.aspect));
    this.controls.target.copy(centre);
    this.camera.position.copy(centre).add(new Vector3(x, y, z).normalize().multiplyScalar(distance));
    this.camera.near = 1e-3 * distance;
    this.camera.far = 1e3 * distance;
    this.camera.updateProjectionMatrix();
    this.controls.update();
    this.view.invalidate();
  }

  private setTime(): void {
    const { time } = this.state;
    for (const { line, times } of this.growing) {
      const last = lastUpTo(times, time);
      line.visible = last >= 1;
      line.geometry.instanceCount = Math.max(0, last);
    }
    for (const { pyramid, trajectories } of this.marks) {
      pyramid.visible = false;
      for (const trajectory of trajectories) {
        const t = numbers(trajectory.t);
        const p = vectorAt(t, trajectory.p, time);
        if (!p.every((value) => Number.isFinite(value))) continue;
        pyramid.position.set(...p);
        pyramid.quaternion.copy(new Quaternion(...orientationAt(t, trajectory.q, time)));
        pyramid.visible = true;
      }
    }
  }

  /// The scale holds at the distance of the point that the view turns around.
  private drawScale(width: number, height: number): void {
    const distance = this.camera.position.distanceTo(this.controls?.target ?? this.centre);
    const metres = (2 * distance * Math.tan((0.5 * this.camera.fov * Math.PI) / 180)) / height; // a pixel
    const length = roundLength(0.3 * Math.min(width, 500) * metres);
    this.scaleBar.style.width = `${length / metres}px`;
    const unit = this.state.run?.alignment ? "m" : this.state.sequence?.ground_truth ? "m" : "units";
    this.scaleBar.textContent = `${Number(length.toPrecision(3))} ${unit}`;
    this.scaleBar.title = "at the distance of the centre of the view";
    this.axisEnds.forEach((end, axis) => {
      const name = this.axisNames[axis];
      if (!name) return;
      const at = end.clone().project(this.camera);
      name.hidden = !(Math.abs(at.x) < 1 && Math.abs(at.y) < 1 && at.z < 1);
      name.style.left = `${(0.5 + 0.5 * at.x) * width}px`;
      name.style.top = `${(0.5 - 0.5 * at.y) * height}px`;
    });
  }

  /// Numbers at the time of the cursor.
  private write(): void {
    const { state } = this;
    const rows = state.shown.flatMap((index) => {
      const run = state.payload.runs[index];
      if (!run) return [];
      const parts = estimatesOf(run, state.estimate);
      const at = (value: (t: Float64Array, part: (typeof parts)[number]) => number): number =>
        parts.map((part) => value(numbers(part.estimate.t), part)).find((number) => Number.isFinite(number)) ?? NaN;
      const position = [0, 1, 2].map((axis) => at((t, { estimate }) => valueAt(t, numbers(estimate.p[axis as 0 | 1 | 2]), state.time)));
      const speed = at((t, { estimate }) => (estimate.v ? Math.hypot(...vectorAt(t, estimate.v, state.time)) : NaN));
      const error = at((t, { estimate }) => (estimate.error_m ? valueAt(t, numbers(estimate.error_m), state.time) : NaN));
      const angle = at((t, { estimate }) => (estimate.error_deg ? valueAt(t, numbers(estimate.error_deg), state.time) : NaN));
      const cells = [...position, speed, error, angle].map((value) => element("td", { class: "number" }, format(value, 3)));
      const name = element("td", {}, run.name);
      name.style.borderLeft = `4px solid ${colourOf(state.slot(index))}`;
      return [element("tr", {}, name, ...cells)];
    });
    const headers = [`at ${state.time.toFixed(2)} s`, "x [m]", "y [m]", "z [m]", "speed [m/s]", "ATE [m]", "ATE [deg]"];
    this.readout.replaceChildren(
      element(
        "table",
        { class: "plain" },
        element("thead", {}, element("tr", {}, ...headers.map((header, i) => element("th", { class: i > 0 ? "number" : "" }, header)))),
        element("tbody", {}, ...rows),
      ),
    );
  }

  private keys(event: KeyboardEvent): void {
    if (!this.controls || event.ctrlKey || event.metaKey || event.altKey) return;
    const arm = this.camera.position.clone().sub(this.controls.target);
    const turn = (angle: number): void => void arm.applyAxisAngle(this.camera.up, angle);
    const lift = (angle: number): void => {
      const side = new Vector3().crossVectors(this.camera.up, arm).normalize();
      const lifted = arm.clone().applyAxisAngle(side, angle);
      if (Math.abs(lifted.clone().normalize().dot(this.camera.up)) < 0.995) arm.copy(lifted);
    };
    const actions: Record<string, () => void> = {
      ArrowLeft: () => turn(-0.1),
      ArrowRight: () => turn(0.1),
      ArrowUp: () => lift(-0.1),
      ArrowDown: () => lift(0.1),
      "+": () => void arm.multiplyScalar(0.85),
      "=": () => void arm.multiplyScalar(0.85),
      "-": () => void arm.multiplyScalar(1 / 0.85),
      ",": () => timeKeys(this.state, new KeyboardEvent("keydown", { key: "ArrowLeft" })),
      ".": () => timeKeys(this.state, new KeyboardEvent("keydown", { key: "ArrowRight" })),
    };
    const action = actions[event.key];
    if (!action) return;
    event.preventDefault();
    action();
    this.camera.position.copy(this.controls.target).add(arm);
    this.controls.update();
    this.view.invalidate();
  }

  private save(): void {
    this.view.drawIfNeeded(true);
    this.renderer?.domElement.toBlob((blob) => {
      if (blob) saveBlob(blob, `${fileName(`3D ${this.state.run?.name ?? ""}`)}.png`);
    });
  }
}

export function sceneElement(state: State): HTMLElement {
  return new SceneView(state).element;
}
