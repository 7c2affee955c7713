// The line's quality in words, with the numbers behind them on demand.
import { element, setText, showText } from "./dom";
import { byteWords, lineWords } from "./line";
import type { Line } from "./lidars";
import { Mark } from "./marks";
import { NONE, whole } from "./words";

export class LinePanel {
  private readonly quality = element("line-quality", HTMLElement);
  private readonly warning = element("line-warning", HTMLElement);
  private readonly mark = new Mark("rest");
  private readonly words = document.createElement("span");
  private readonly numbers = {
    bytes: element("line-bytes", HTMLElement),
    samples: element("line-samples", HTMLElement),
    damaged: element("line-damaged", HTMLElement),
    lost: element("line-lost", HTMLElement),
    stray: element("line-stray", HTMLElement),
  };

  constructor() {
    this.quality.append(this.mark.element, this.words);
  }

  show(line: Line | undefined): void {
    const { words, mark } = lineWords(line);
    this.mark.show(mark);
    setText(this.words, words);
    showText(this.warning, line?.warning ?? "");
    const count = (value: bigint | undefined) =>
      value === undefined ? NONE : whole(Number(value));
    setText(this.numbers.bytes, line ? byteWords(line.bytes) : NONE);
    setText(this.numbers.samples, count(line?.samples));
    setText(this.numbers.damaged, count(line?.checksumErrors));
    setText(this.numbers.lost, count(line?.lostPackets));
    setText(this.numbers.stray, count(line?.skippedBytes));
  }
}
