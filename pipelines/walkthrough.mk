# pipelines/walkthrough.mk -- METHOD=walkthrough: key frames are rendered, frames between them warped, the rest of their pixels traced.
# Included by Makefile.example in place of its rule for pictures; walkthrough.md is its page.
KEY_DISTANCE = 16#       frames between the first keys; intervals are halved where that is too far
THRESHOLD    = $(if $(filter draft,$(QUALITY)),0.035,0.01)# relMSE between what two keys give for the frame in their middle, above which an interval is halved
walkthrough  = $(dir $(lastword $(MAKEFILE_LIST)))walkthrough.sh

# Keys need depth, normals, objects, and the layer of light by mirrors, glass and gloss.
comma       := ,
asked        = $(subst $(comma), ,$(CHANNELS))
missing      = $(filter-out $(asked),Z N id $(if $(filter layers,$(asked)),,specular))
options_keys = $(subst --channels $(CHANNELS),--channels $(CHANNELS)$(missing:%=$(comma)%),$(options_frames))
options_walk = $(KEY_DISTANCE) $(THRESHOLD)
STAGES      += keys walk
intervals   := $(if $(word 2,$(plan_pictures)),$(shell sh $(walkthrough) intervals $(KEY_DISTANCE) $(plan_pictures)))
ends         = $(subst +, ,$1)
between      = $(shell sh $(walkthrough) between $(call ends,$1) $(plan_pictures))
lit_of       = $(call lit,$(photons_$1)) $(addprefix --lights ,$(call lights_of,$1))
$(if $(plan_frames),$(shell mkdir -p $(OUT)/keys $(OUT)/walk)$(call note,keys)$(call note,walk))

# A key is rendered as every frame is without METHOD.
$(OUT)/keys/%.exr: $$(camera_$$*) $$(light_$$*) $$(call lit_files,$$(photons_$$*)) $$(call lights_of,$$*) $(OUT)/options/keys $(BIN)/frame-render
	$(RUN) $(BIN)/frame-render $(SCENE) --frame $* $(call lit_of,$*) $(options_keys) -o $@ --stats $(@:.exr=.json)

# An interval: warped, or halved by the same rule. What its frames show is looked at again if a camera or a light in it changed.
inside = $(call ends,$1) $(call between,$1)
export OUT THRESHOLD
$(OUT)/walk/%.done: $$(foreach f,$$(call ends,$$*),$(OUT)/keys/$$f.exr) \
  $$(foreach f,$$(call inside,$$*),$$(camera_$$f) $$(light_$$f) $$(call lit_files,$$(photons_$$f)) $$(call lights_of,$$f)) \
  $(OUT)/options/walk $(BIN)/ibr-warp $(BIN)/aqm-compare $(BIN)/frame-render
	+@$(foreach f,$(call between,$*),LIT_$f='$(call lit_of,$f)') $(walk_commands) \
	  sh $(walkthrough) interval $(call inside,$*)
	@touch $@
walk_commands = WARP='$(RUN) $(BIN)/ibr-warp --scene $(SCENE) --camera $(CAMERA) $(shared)' COMPARE='$(RUN) $(BIN)/aqm-compare' \
  RENDER='$(RUN) $(BIN)/frame-render $(SCENE) $(options_keys)' MAKE_INTERVALS='$(MAKE) -f $(firstword $(MAKEFILE_LIST)) --no-print-directory'
.SECONDARY:

# Frames are made by the interval they lie in; one that was deleted is made again.
$(foreach i,$(intervals),$(foreach f,$(call inside,$i),$(eval walk_of_$f := $i)))
$(pictures): $(OUT)/frames/%.exr: $$(if $$(walk_of_$$*),$(OUT)/walk/$$(walk_of_$$*).done,$(OUT)/keys/%.exr)
	@test -f $@ || LIT_$*='$(call lit_of,$*)' $(walk_commands) sh $(walkthrough) frame $*
	@touch $@

# Where keys were placed and why, in the order of frames.
demo: $(if $(intervals),$(OUT)/walk.log)
$(OUT)/walk.log: $(intervals:%=$(OUT)/walk/%.done)
	@cat $(intervals:%=$(OUT)/walk/%.log) > $@

# Keys have a border in the sheet.
marks = $(if $(intervals),--mark "$$(OUT='$(OUT)' sh $(walkthrough) keys)")
$(OUT)/sheet.png: $(if $(intervals),$(OUT)/walk.log)
