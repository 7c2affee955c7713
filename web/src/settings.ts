// What the page remembers: in the address, so that a link or a reload shows the same.
import type { ColourBy } from "./ramp";

export interface Settings {
  /// Id of the lidar that the user chose; empty: none yet.
  lidar: string;
  colourBy: ColourBy;
}

/// Reads the part of the address after "#". Anything strange in it is left out.
export function parseSettings(hash: string): Settings {
  const parameters = new URLSearchParams(hash.replace(/^#/, ""));
  return {
    lidar: parameters.get("lidar") ?? "",
    colourBy: parameters.get("colour") === "quality" ? "quality" : "range",
  };
}

/// The part of the address after "#", with the "#"; empty if there is nothing to remember.
export function formatSettings(settings: Settings): string {
  const parameters = new URLSearchParams();
  if (settings.lidar) parameters.set("lidar", settings.lidar);
  if (settings.colourBy !== "range") parameters.set("colour", settings.colourBy);
  const text = parameters.toString();
  return text ? `#${text}` : "";
}
