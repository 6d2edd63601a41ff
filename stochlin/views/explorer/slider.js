// A native slider: reached by Tab and named by its label. Its value is told, not bound, so that a late
// answer of the server does not move it under the hand.
export default {
  template: `<input type="range" :min="min" :max="max" :step="step" @input="$emit('slide', $el.valueAsNumber)" />`,
  props: { start: Number, min: Number, max: Number, step: Number },
  mounted() {
    this.show(this.start);
  },
  methods: {
    show(value) {
      this.$el.value = value;
    },
  },
};
