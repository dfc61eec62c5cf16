"use strict";
// Light groups with other weights: sums of the light of each alone, and what may be claimed for these (see `solve/relight.rs`).
// Of `data.light_groups`, and the radiosities of each group alone by group, node and channel.
const patchlightGroups = (known, apart) => {
  const { groups, claims } = known;
  const solved = groups.map((group) => group.factor);

  // Replaces the radiosities of nodes and the exitance of materials by those with these factors. In the dark noise may take the sum below zero.
  const apply = (factors, radiosity, materials) => {
    const length = radiosity.length;
    for (let k = 0; k < length; k++) {
      let sum = 0;
      for (let g = 0; g < factors.length; g++) sum += factors[g] * apart[g * length + k];
      radiosity[k] = Math.max(sum, 0);
    }
    materials.forEach((material, m) => {
      material.exitance = material.exitance.map((_, c) => factors.reduce((sum, factor, g) => sum + factor * groups[g].exitance[m][c], 0));
    });
  };

  // The least of |s| e_all + sum of |w_g - s| e_g over s; what has no part in the sum may be unknown.
  const boundError = (errors, weights) => {
    const term = (factor, error) => (factor === 0 ? 0 : factor * (error ?? Infinity));
    const boundWith = (s) => weights.reduce((sum, of, g) => sum + term(Math.max(...of.map((w) => Math.abs(w - s))), errors[g + 1]), term(s, errors[0]));
    return Math.min(...[0, ...weights.flat()].map(boundWith));
  };

  // The claim by energy for these factors, infinite where nothing is known.
  const claim = (factors) => {
    if (!claims) return Infinity;
    const weights = groups.map((group, g) => group.weights.map((weight) => factors[g] * weight));
    let light = 0;
    weights.forEach((first, g) =>
      weights.forEach((second, h) => first.forEach((weight, b) => (light += weight * second[b] * claims.products[(g * groups.length + h) * first.length + b]))),
    );
    const relative = (errors) => {
      const error = boundError(errors, weights);
      return error === 0 ? 0 : error / Math.sqrt(Math.max(light, 0));
    };
    return claims.mesh ? Math.hypot(relative(claims.values), relative(claims.mesh)) : relative(claims.values);
  };

  // The command that does the same with the stored solution.
  const command = (factors) => {
    const set = groups.flatMap((group, g) => {
      if (factors[g] === solved[g]) return [];
      const weights = group.weights.map((weight) => Number((factors[g] * weight).toPrecision(6)));
      const text = `${group.name}=${weights.every((weight) => weight === weights[0]) ? weights[0] : weights.join(",")}`;
      return [`--set ${/^[\w.,=-]+$/.test(text) ? text : `'${text.replaceAll("'", "'\\''")}'`}`];
    });
    return ["patchlight relight FILE.solution", ...set].join(" ");
  };

  return { names: groups.map((group) => group.name), solved, apply, claim, command };
};
