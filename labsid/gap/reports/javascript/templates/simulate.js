// The output of an exported simulation, as labsid.gap.fits.hypothesis.Hypothesis.output. Signals are scaled, time is in samples.
function actuator(model, theta, u) {
  let w = u;
  for (const effect of model.inputs) w = effect.run(effect.self, w, theta.slice(...effect.at), model.span);
  const [delay, ...offsets] = theta.slice(...model.delay);
  const whole = Math.floor(delay);
  return [_kernels_delayed(w, whole, 0, np.sum(offsets)), delay - whole];
}

// The dynamics of a model that is not simulated here, and what belongs to one of several records, are its `constant`.
function simulate(model, theta, gains, u) {
  const own = theta.slice(...model.plant.at);
  const added = model.additive.map((effect) => (
    effect.run(effect.self, theta.slice(...effect.at), u.length, model.span, model.plant.self, own)));
  const dynamics = () => {
    const [w, late] = actuator(model, theta, u);
    return [plants_Plant_columns(model.plant.self, own, w, model.span, model.reference, late)];
  };
  const atLoad = added.filter((_, i) => model.additive[i].at_load);
  const atSensor = added.filter((_, i) => !model.additive[i].at_load);
  const sensed = np.column_stack([...(model.simulated === false ? [] : dynamics()), np.ones(u.length), ...atLoad]);
  let z = np.matmul(sensed, gains.slice(0, sensed.cols));
  if (model.constant) z = np.add(z, model.constant);
  for (const effect of model.outputs) if (!effect.limits) z = effect.run(effect.self, z, theta.slice(...effect.at));
  if (atSensor.length) z = np.add(z, np.matmul(np.column_stack(atSensor), gains.slice(sensed.cols)));
  for (const effect of model.outputs) if (effect.limits) z = effect.run(effect.self, z, theta.slice(...effect.at));
  return z;
}
