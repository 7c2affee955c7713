// "What is wrong?": has the gateway examine a lidar, and shows what it found.
import { diagnose } from "./api";
import { headline, sentence, verdictWords, type Diagnosis } from "./diagnosis";
import { element, setText, showText } from "./dom";
import { lidarName, type Lidar } from "./lidars";
import { Mark } from "./marks";
import { duration } from "./words";

export class DiagnosisDialog {
  private readonly dialog = element("diagnosis", HTMLDialogElement);
  private readonly subject = element("diagnosis-lidar", HTMLElement);
  private readonly progress = element("diagnosis-progress", HTMLElement);
  private readonly elapsed = element("diagnosis-elapsed", HTMLElement);
  private readonly outcome = element("diagnosis-outcome", HTMLElement);
  private readonly outcomeMark = new Mark("rest");
  private readonly outcomeWords = document.createElement("strong");
  private readonly hint = element("diagnosis-hint", HTMLElement);
  private readonly findings = element("diagnosis-findings", HTMLElement);
  private readonly checks = element("diagnosis-checks", HTMLElement);
  private readonly again = element("diagnosis-again", HTMLButtonElement);
  /// One for when the lidar is in trouble, one for when it is not; the other is hidden.
  private readonly openers = [
    element("diagnose-now", HTMLButtonElement),
    element("diagnose", HTMLButtonElement),
  ];

  private lidar: Lidar | undefined;
  private running: AbortController | undefined;

  /// `base` is the page's address.
  constructor(private readonly base: string) {
    this.outcome.append(this.outcomeMark.element, this.outcomeWords);
    for (const opener of this.openers) opener.addEventListener("click", () => this.open());
    this.again.addEventListener("click", () => {
      if (!this.running) void this.run();
    });
    element("diagnosis-close", HTMLButtonElement).addEventListener("click", () =>
      this.dialog.close(),
    );
    this.dialog.addEventListener("click", (event) => {
      if (event.target === this.dialog) this.dialog.close();
    });
    // However it was closed, also by Escape.
    this.dialog.addEventListener("close", () => this.closed());
  }

  /// Offers the diagnosis of this lidar: plainly if it is in `trouble`.
  offer(lidar: Lidar | undefined, connected: boolean, trouble: boolean): void {
    if (!this.dialog.open) this.lidar = lidar;
    const [now, aside] = this.openers as [HTMLButtonElement, HTMLButtonElement];
    const focused = this.openers.includes(document.activeElement as HTMLButtonElement);
    now.hidden = !lidar || !connected || !trouble;
    aside.hidden = !lidar || !connected || trouble;
    if (focused) this.openers.find((each) => !each.hidden)?.focus();
  }

  private open(): void {
    if (!this.lidar || this.dialog.open) return;
    this.dialog.showModal();
    void this.run();
  }

  private async run(): Promise<void> {
    const lidar = this.lidar;
    if (!lidar) return;
    const running = new AbortController();
    this.running = running;
    setText(this.subject, subjectOf(lidar));
    this.begin();
    const began = performance.now();
    const tick = () => setText(this.elapsed, duration((performance.now() - began) / 1000));
    tick();
    const timer = setInterval(tick, 1000);
    const answer = await diagnose(this.base, lidar.id, running.signal);
    clearInterval(timer);
    // Closed meanwhile, and perhaps opened again.
    if (this.running !== running) return;
    this.running = undefined;
    this.progress.hidden = true;
    this.again.setAttribute("aria-disabled", "false");
    if ("trouble" in answer) {
      this.outcomeMark.show("failed");
      setText(this.outcomeWords, sentence(answer.trouble.message));
      showText(this.hint, sentence(answer.trouble.hint));
    } else {
      this.show(answer.value);
    }
  }

  private begin(): void {
    this.progress.hidden = false;
    this.again.setAttribute("aria-disabled", "true");
    this.outcomeMark.show("busy");
    setText(this.outcomeWords, "Looking for what is wrong…");
    this.hint.hidden = true;
    this.findings.replaceChildren();
    this.checks.replaceChildren();
  }

  private show(diagnosis: Diagnosis): void {
    this.outcomeMark.show(verdictWords(diagnosis.verdict).mark);
    setText(this.outcomeWords, headline(diagnosis));
    this.findings.replaceChildren(
      ...section("Likely causes, the likeliest first", diagnosis.likelyCauses),
      ...section("What to do", diagnosis.nextSteps),
    );
    const rows = diagnosis.checks.map((check) => {
      const { word, mark } = verdictWords(check.verdict);
      const row = document.createElement("li");
      row.dataset["verdict"] = mark;
      const words = document.createElement("div");
      words.append(textOf("strong", check.title), textOf("span", word, "verdict"));
      if (check.finding) words.append(textOf("p", check.finding, "quiet"));
      row.append(new Mark(mark).element, words);
      return row;
    });
    if (rows.length === 0) return;
    const list = document.createElement("ol");
    list.append(...rows);
    this.checks.replaceChildren(textOf("h3", "What was checked"), list);
  }

  private closed(): void {
    const running = this.running;
    this.running = undefined;
    running?.abort();
    // The browser gives the focus back to what opened it, unless that is gone by now.
    if (document.activeElement === document.body) {
      this.openers.find((each) => !each.hidden)?.focus();
    }
  }
}

function subjectOf(lidar: Lidar): string {
  const name = lidarName(lidar);
  return name === lidar.url ? name : `${name}, at ${lidar.url}`;
}

function section(title: string, entries: readonly string[]): HTMLElement[] {
  if (entries.length === 0) return [];
  const list = document.createElement("ol");
  list.append(...entries.map((entry) => textOf("li", sentence(entry))));
  return [textOf("h3", title), list];
}

function textOf(tag: string, text: string, className = ""): HTMLElement {
  const made = document.createElement(tag);
  made.textContent = text;
  made.className = className;
  return made;
}
