// The sign that the connection is lost, with the time to the next attempt.
import type { ConnectionState } from "./connection";
import { element, setText, showText } from "./dom";

export class Banner {
  private readonly banner = element("banner", HTMLElement);
  private readonly reason = element("banner-reason", HTMLElement);
  private readonly countdown = element("banner-countdown", HTMLElement);
  private readonly link = element("link", HTMLElement);
  private wasLost = false;

  constructor(onRetry: () => void) {
    element("banner-retry", HTMLButtonElement).addEventListener("click", onRetry);
  }

  /// Shows the state of the connection at `now`, on the clock of its `retryAt`.
  show(state: ConnectionState, now: number): void {
    if (state.kind === "lost") this.wasLost = true;
    if (state.kind === "open") this.wasLost = false;
    // Stays while the next attempt runs, so that it does not blink.
    this.banner.hidden = !this.wasLost;
    this.link.dataset["state"] = this.wasLost ? "lost" : state.kind;
    setText(this.link, LINK_WORDS[this.wasLost ? "lost" : state.kind]);
    if (state.kind === "lost") {
      showText(this.reason, state.reason);
      const left = Math.max(0, Math.ceil((state.retryAt - now) / 1000));
      setText(this.countdown, `Trying again in ${left} s.`);
    } else {
      setText(this.countdown, "Trying again now.");
    }
  }
}

const LINK_WORDS: Record<ConnectionState["kind"], string> = {
  open: "Connected",
  connecting: "Connecting…",
  lost: "Not connected",
};
