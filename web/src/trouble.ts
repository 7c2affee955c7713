// The box that says what went wrong and what to do, until it is dismissed.
import type { Trouble } from "./api";
import { element, setText, showText } from "./dom";

export class TroubleBox {
  private readonly box = element("trouble", HTMLElement);
  private readonly message = element("trouble-message", HTMLElement);
  private readonly hint = element("trouble-hint", HTMLElement);

  constructor() {
    element("trouble-dismiss", HTMLButtonElement).addEventListener("click", () => this.dismiss());
  }

  show(trouble: Trouble): void {
    setText(this.message, trouble.message);
    showText(this.hint, trouble.hint);
    this.box.hidden = false;
  }

  dismiss(): void {
    this.box.hidden = true;
  }
}
