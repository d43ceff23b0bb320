# lights.mk -- what light from far away reaches what the cameras see of a segment, learned once for all its pictures (frame-render
# --learn-lights): where the plan says that it comes through openings (plan_lights). PIXELS without --learn-lights: not learned.
# lights_of F: the file for a picture, or nothing.
lights_of = $(OUT)/lights/$(segment_$1).lightgrid
STAGES += lights
options_lights = --size $(SIZE) --camera $(CAMERA) $(shared)
$(shell mkdir -p $(OUT)/lights)$(call note,lights)
seen_of = $(foreach f,$(plan_pictures),$(if $(filter $1,$(segment_$f)),$f))
$(foreach s,$(sort $(foreach f,$(plan_pictures),$(segment_$f))),$(OUT)/lights/$s.lightgrid): $(OUT)/lights/%.lightgrid: \
  $$(foreach f,$$(call seen_of,$$*),$$(camera_$$f) $$(light_$$f)) $(OUT)/options/lights
	$(RUN) $(BIN)/frame-render $(SCENE) --frames $$(echo $(call seen_of,$*) | tr ' ' ,) --learn-lights $(options_lights) -o $@ --stats $(@:.lightgrid=.json)
