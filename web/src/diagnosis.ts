// A diagnosis in words and marks. Pure.
import { Diagnosis_Verdict, type Diagnosis } from "../gen/sweepcast/v1/api_pb";
import type { MarkKind } from "./marks";

export { Diagnosis_Verdict, DiagnosisSchema, type Diagnosis } from "../gen/sweepcast/v1/api_pb";

export interface VerdictWords {
  word: string;
  mark: MarkKind;
}

/// The outcome of a check in a word or two, and its mark.
export function verdictWords(verdict: Diagnosis_Verdict): VerdictWords {
  switch (verdict) {
    case Diagnosis_Verdict.OK:
      return { word: "Fine", mark: "ok" };
    case Diagnosis_Verdict.WARNING:
      return { word: "Warning", mark: "warning" };
    case Diagnosis_Verdict.FAILED:
      return { word: "Wrong", mark: "failed" };
    case Diagnosis_Verdict.NOT_RUN:
      return { word: "Not checked", mark: "not_run" };
    default:
      return { word: "Unknown", mark: "not_run" };
  }
}

/// What is wrong in one sentence, or that nothing is.
export function headline(diagnosis: Diagnosis): string {
  if (diagnosis.cause !== "") return sentence(diagnosis.cause);
  if (diagnosis.verdict === Diagnosis_Verdict.OK) {
    const skipped = diagnosis.checks.some((check) => check.verdict === Diagnosis_Verdict.NOT_RUN);
    return skipped ? "Nothing is wrong so far; not all could be checked." : "Nothing is wrong.";
  }
  const worst = diagnosis.checks.find((check) => check.verdict === diagnosis.verdict);
  return worst
    ? sentence(`${verdictWords(worst.verdict).word}: ${worst.title}`)
    : "It cannot be told.";
}

/// With a capital and a full stop: the gateway's words are made to stand after a colon, too.
export function sentence(text: string): string {
  if (text === "") return "";
  const begun = text[0]!.toUpperCase() + text.slice(1);
  return /[.!?:]$/.test(begun) ? begun : `${begun}.`;
}
