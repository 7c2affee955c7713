// window.sweepcast: what the page knows, for tests and for a look from the browser's console. Read only.
import { Lidar_State, type Lidar } from "./lidars";
import type { Scene } from "./scene";
import { toScreen } from "./view";

interface Source {
  scene: Scene;
  connected(): boolean;
  lidar(): Lidar | undefined;
  sequence(): bigint;
  missed(): number;
  stale(): boolean;
}

/// Defines window.sweepcast:
///   connected  the stream is open
///   lidar      id of the lidar shown, "" if none
///   state      its state as in lidar.proto: "SCANNING", ...
///   sequence   number of the latest sweep, 0 before the first
///   mode       scan mode that the sweep drawn was measured in, "" if none is drawn
///   missed     gaps in the sequence so far
///   stale      what is drawn is not what the lidar sees now
///   points     number of points of the sweep that is drawn
///   point(k)   one of them: angle_deg, distance_m, quality, its place x, y on the canvas in CSS pixels
///              (it may be out of sight), and its colour as [red, green, blue]
///   view       the part of the floor shown: centreX, centreY (m), scale (CSS pixels a metre), width, height
export function exposeDebugState(source: Source): void {
  const state = {
    get connected() {
      return source.connected();
    },
    get lidar() {
      return source.lidar()?.id ?? "";
    },
    get state() {
      return Lidar_State[source.lidar()?.state ?? Lidar_State.UNKNOWN];
    },
    get sequence() {
      return Number(source.sequence());
    },
    get mode() {
      return source.scene.drawn?.sweep.mode ?? "";
    },
    get missed() {
      return source.missed();
    },
    get stale() {
      return source.stale();
    },
    get points() {
      return source.scene.drawn?.sweep.x.length ?? 0;
    },
    get view() {
      return { ...source.scene.view };
    },
    point: (k: number) => pointOf(source.scene, k),
  };
  Object.defineProperty(window, "sweepcast", { value: Object.freeze(state) });
}

function pointOf(scene: Scene, k: number) {
  const { drawn } = scene;
  if (!drawn || !(k >= 0 && k < drawn.sweep.x.length)) return undefined;
  const { sweep, view, index, palette } = drawn;
  const colour = new Uint8Array(palette.buffer, index[k]! * 4, 3);
  return {
    angle_deg: sweep.angleDeg[k],
    distance_m: sweep.distanceM[k],
    quality: sweep.quality[k],
    ...toScreen(view, sweep.x[k]!, sweep.y[k]!),
    colour: [...colour],
  };
}
