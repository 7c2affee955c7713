// The list of lidars to choose from, each with its model and state. Not shown for a single one.
import { element, setText } from "./dom";
import { stateWords } from "./lidar_state";
import { inTrouble, Lidar_State, lidarTitle, type Lidar } from "./lidars";
import { Mark } from "./marks";

class Row {
  readonly element = document.createElement("label");
  readonly input = document.createElement("input");
  private readonly mark = new Mark("rest");
  private readonly title = document.createElement("strong");
  private readonly place = document.createElement("span");
  private readonly state = document.createElement("span");

  constructor(onPick: (id: string) => void) {
    this.element.className = "lidar";
    this.input.type = "radio";
    this.input.name = "lidar";
    this.input.addEventListener("change", () => onPick(this.input.value));
    this.place.className = "quiet place";
    this.state.className = "state-of";
    this.element.append(this.input, this.mark.element, this.title, this.place, this.state);
  }

  show(lidar: Lidar, chosen: boolean, connected: boolean): void {
    const { word, tone } = connected
      ? stateWords(lidar.state, inTrouble(lidar))
      : stateWords(Lidar_State.UNKNOWN);
    const { title, place } = lidarTitle(lidar);
    this.input.value = lidar.id;
    this.input.checked = chosen;
    this.element.dataset["tone"] = tone;
    this.element.dataset["chosen"] = String(chosen);
    this.mark.show(tone);
    setText(this.title, title);
    setText(this.place, place);
    setText(this.state, word);
  }
}

export class LidarList {
  private readonly list = element("lidars", HTMLElement);
  private rows = new Map<number, Row>();

  /// `onPick` is called with the id of a lidar.
  constructor(private readonly onPick: (id: string) => void) {}

  show(lidars: readonly Lidar[], chosen: Lidar | undefined, connected: boolean): void {
    this.list.hidden = lidars.length < 2;
    // Rows stay as they are while their lidars do: the focus may be on one.
    const same =
      lidars.length === this.rows.size && lidars.every(({ number }) => this.rows.has(number));
    if (!same) {
      this.rows = new Map(lidars.map(({ number }) => [number, new Row(this.onPick)]));
      this.list.replaceChildren(...[...this.rows.values()].map((row) => row.element));
    }
    for (const lidar of lidars) {
      this.rows.get(lidar.number)!.show(lidar, lidar.number === chosen?.number, connected);
    }
  }
}
