// A diagnosis in words, and how it is read from the gateway's answer.
import assert from "node:assert/strict";
import { test } from "node:test";
import { create } from "@bufbuild/protobuf";
import { diagnosisOf } from "../../web/src/api";
import {
  Diagnosis_Verdict,
  DiagnosisSchema,
  headline,
  sentence,
  verdictWords,
} from "../../web/src/diagnosis";

const VERDICTS = Object.values(Diagnosis_Verdict).filter(
  (verdict): verdict is Diagnosis_Verdict => typeof verdict === "number",
);

test("every verdict has a word of its own", () => {
  const words = VERDICTS.map((verdict) => verdictWords(verdict).word);
  assert.equal(new Set(words).size, VERDICTS.length);
});

test("fine, not so good, wrong and not looked at differ in shape, too", () => {
  const { OK, WARNING, FAILED, NOT_RUN } = Diagnosis_Verdict;
  const marks = [OK, WARNING, FAILED, NOT_RUN].map((verdict) => verdictWords(verdict).mark);
  assert.deepEqual(marks, ["ok", "warning", "failed", "not_run"]);
});

test("a verdict that this page does not know is called unknown", () => {
  assert.equal(verdictWords(99 as Diagnosis_Verdict).word, "Unknown");
});

test("the headline is the cause, as a sentence", () => {
  const diagnosis = create(DiagnosisSchema, {
    verdict: Diagnosis_Verdict.FAILED,
    cause: "there is no /dev/ttyUSB0",
  });
  assert.equal(headline(diagnosis), "There is no /dev/ttyUSB0.");
});

test("where nothing is wrong that is the headline", () => {
  const fine = create(DiagnosisSchema, { verdict: Diagnosis_Verdict.OK });
  assert.equal(headline(fine), "Nothing is wrong.");
});

test("what was not checked is not claimed to be right", () => {
  const fine = create(DiagnosisSchema, {
    verdict: Diagnosis_Verdict.OK,
    checks: [{ verdict: Diagnosis_Verdict.OK }, { verdict: Diagnosis_Verdict.NOT_RUN }],
  });
  assert.match(headline(fine), /so far/);
});

test("without a cause the check that went wrong is the headline", () => {
  const diagnosis = create(DiagnosisSchema, {
    verdict: Diagnosis_Verdict.WARNING,
    checks: [
      { title: "It opens", verdict: Diagnosis_Verdict.OK },
      { title: "The line is clean", verdict: Diagnosis_Verdict.WARNING },
    ],
  });
  assert.equal(headline(diagnosis), "Warning: The line is clean.");
  assert.equal(headline(create(DiagnosisSchema)), "It cannot be told.");
});

test("a sentence has a capital and one stop", () => {
  assert.equal(sentence("try another cable"), "Try another cable.");
  assert.equal(sentence("Is it on?"), "Is it on?");
  assert.equal(sentence(""), "");
});

test("a diagnosis is read from the gateway's JSON", () => {
  const body = {
    port: "/dev/ttyUSB0",
    verdict: "FAILED",
    checks: [{ id: "port", title: "The port exists", verdict: "FAILED", finding: "no such file" }],
    cause: "there is no /dev/ttyUSB0",
    likely_causes: ["the lidar is not plugged in"],
    next_steps: ["plug it in"],
    ofALaterVersion: 1,
  };
  const answer = diagnosisOf(JSON.stringify(body));
  assert.ok("value" in answer);
  assert.equal(answer.value.checks[0]!.verdict, Diagnosis_Verdict.FAILED);
  assert.deepEqual(answer.value.likelyCauses, ["the lidar is not plugged in"]);
  assert.deepEqual(answer.value.nextSteps, ["plug it in"]);
});

for (const body of ["", "<html>", "[]", '{"checks": 3}']) {
  test(`an answer that is no diagnosis is told as trouble: ${body || "nothing"}`, () => {
    assert.ok("trouble" in diagnosisOf(body));
  });
}
