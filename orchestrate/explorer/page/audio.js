/** Impacts made audible; silent until asked for. */

/** A loop of clicks that can be started and stopped. */
export class Sound {
  constructor() {
    this.wanted = false; // motions that are shown next are heard too
    this.context = /** @type {AudioContext | null} */ (null);
    this.source = /** @type {AudioBufferSourceNode | null} */ (null);
  }

  /** No more, whatever is shown next. */
  silence() {
    this.wanted = false;
    this.stop();
    void this.context?.suspend(); // the machine's sound is let go
  }

  /** Samples a second. */
  get rate() {
    this.context ??= new AudioContext();
    return this.context.sampleRate;
  }

  /** @param {Float32Array} wave */
  play(wave) {
    this.stop();
    if (!wave.length) return;
    this.context ??= new AudioContext();
    const buffer = this.context.createBuffer(1, wave.length, this.context.sampleRate);
    buffer.getChannelData(0).set(wave);
    this.source = new AudioBufferSourceNode(this.context, { buffer, loop: true });
    this.source.connect(this.context.destination);
    this.source.start();
    void this.context.resume();
  }

  stop() {
    this.source?.stop();
    this.source = null;
  }
}
