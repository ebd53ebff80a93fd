//! Files of latent models: the same bits again, and whatever cannot be used is refused with its place.

use crate::common::circles;
use sinew_core::decode::Decode;
use sinew_core::lanes::Isa;
use sinew_dynamics::model_file::is_of;
use sinew_latent::file::{FORMAT, LatentFileError, LatentKind, StoredModel, check, read, write};
use sinew_latent::hgplvm::PlannedNode;
use sinew_latent::model::{LatentModel, Outputs, RootPrior};
use sinew_latent::motion::{LatentMotion, StepNoise};
use sinew_latent::space::Below;
use sinew_latent::training::{Config, Training};
use sinew_latent::{gpdm, gplvm, hgplvm};

const LENGTHS: [usize; 2] = [9, 7];

fn learned(model: LatentModel) -> LatentModel {
    let mut training = Training::new(model, Config { steps: 5, ..Config::default() }, Isa::baseline()).unwrap();
    training.run(|_| true);
    training.into_model()
}

fn stored(kind: LatentKind) -> StoredModel {
    let rows = circles(6, &LENGTHS, 0.01, 3);
    let model = match kind {
        LatentKind::Gplvm => {
            gplvm::model(&rows, 6, &gplvm::Config { dim: 2, back: Some(1e-3), ..gplvm::Config::default() })
        }
        LatentKind::Gpdm => gpdm::model(&rows, 6, &LENGTHS, &gpdm::Config { dim: 2, ..gpdm::Config::default() }),
        LatentKind::Hgplvm => {
            let leaf = |columns: &[usize]| PlannedNode { parent: Some(0), dim: 2, columns: columns.to_vec() };
            let tree = vec![PlannedNode { parent: None, dim: 2, columns: vec![] }, leaf(&[0, 3, 1]), leaf(&[2, 4, 5])];
            hgplvm::model(&rows, 6, &LENGTHS, &[1, 1], &hgplvm::Config { tree, root_per_motion: true })
        }
    };
    StoredModel { state: "circles".into(), frame_rate: 20.0, free: 6, kind, model: learned(model.unwrap()) }
}

#[test]
fn models_are_read_bit_for_bit_as_written_and_decode_as_before() {
    for kind in LatentKind::ALL {
        let model = stored(kind);
        let text = write("m.json", &model).unwrap();
        let again = read("m.json", &text).unwrap();
        assert_eq!(again, model, "{kind}");
        assert_eq!(write("m.json", &again).unwrap(), text);
        assert!(
            is_of(FORMAT, &text) && text.starts_with("{\"format\":\"sinew latent model\",\"version\":1,\"state\":")
        );
        let decoded = |model: &LatentModel| {
            let below = Below::new(model, 0, Isa::baseline()).unwrap();
            let latent = below.encode(model.row(4)).unwrap();
            let mut row = vec![0.0; 6];
            below.decode(&latent, &mut row);
            (latent, row)
        };
        assert_eq!(decoded(&again.model), decoded(&model.model), "{kind}");
        assert_eq!(LatentKind::find(kind.name()), Some(kind));
    }
}

#[test]
fn other_files_and_versions_are_refused() {
    let text = write("m.json", &stored(LatentKind::Gplvm)).unwrap();
    let refused = |text: &str| read("m.json", text).unwrap_err();
    assert_eq!(
        refused(&text.replace("\"version\":1", "\"version\":2")).to_string(),
        "m.json is a latent model of version 2; expected 1"
    );
    assert_eq!(
        refused("{\"format\": \"sinew motion model\", \"version\": 1}").to_string(),
        "m.json is no latent model: its `format` is \"sinew motion model\"; expected \"sinew latent model\""
    );
    for (from, to) in [
        ("\"version\":1", "\"version\":1,\"more\":0"),
        ("\"free\":6", "\"free\":-6"),
        ("\"kind\":\"gplvm\"", "\"kind\":\"pca\""),
        ("\"columns\":6", "\"columns\":6,\"columns\":6"),
        ("\"frame_rate\":20.0", "\"frame_rate\":1e999"),
    ] {
        assert!(text.contains(from), "{from}");
        let error = refused(&text.replacen(from, to, 1));
        assert!(matches!(error, LatentFileError::Json { .. }), "{to}: {error}");
    }
}

/// What is changed, and words of the message.
type Change = (&'static str, fn(&mut StoredModel));

const OF_ALL: [Change; 20] = [
    ("`state`", |m| m.state.clear()),
    ("`frame_rate`", |m| m.frame_rate = f64::NAN),
    ("coordinates that are not in the model", |m| m.free = usize::MAX),
    ("columns; expected at most 1000", |m| m.model.columns = usize::MAX),
    ("data", |m| m.model.columns = 0),
    ("number of the data 3", |m| m.model.data[3] = 1e7),
    ("all sequences together", |m| m.model.sequences[0] = usize::MAX),
    ("a sequence has 0", |m| m.model.sequences.push(0)),
    ("mean 1", |m| m.model.standard.mean[1] = f64::NEG_INFINITY),
    ("divisor 5", |m| m.model.standard.scale[5] = 1e-300),
    ("nodes has 0", |m| m.model.nodes.clear()),
    ("rows of a node", |m| m.model.nodes[0].rows.end = usize::MAX),
    ("rows of whole sequences", |m| m.model.nodes[0].rows.end -= 1),
    ("coordinates of a latent", |m| m.model.nodes[0].dim = usize::MAX),
    ("latent 2", |m| m.model.nodes[0].latents[2] = f64::NAN),
    ("latents of a node", |m| m.model.nodes[0].latents.truncate(3)),
    ("covariance parameter", |m| m.model.nodes[0].covariance.variance = 1e300),
    ("white noise", |m| m.model.nodes[0].covariance.white = 0.0),
    ("learned covariance parameter 2", |m| m.model.nodes[0].learned[2] = true),
    ("kappa", |m| m.model.kappa = Some(0.0)),
];

/// Changes of rows and latents, which may be refused by either place.
const EITHER: [&str; 3] = ["rows of a node", "rows of whole sequences", "covariances of all nodes"];

#[test]
fn each_broken_value_is_refused_by_its_place() {
    let refused = |kind: LatentKind, (words, change): Change| {
        let mut broken = stored(kind);
        change(&mut broken);
        let message = check(&broken).expect_err(words).to_string();
        let is_either = EITHER.contains(&words)
            && (EITHER.iter().any(|w| message.contains(w)) || message.contains("latents of a node"));
        assert!(message.contains(words) || is_either, "{kind}, {words}: {message}");
        assert!(write("m.json", &broken).is_err());
    };
    for kind in LatentKind::ALL {
        OF_ALL.into_iter().for_each(|change| refused(kind, change));
    }
    refused(LatentKind::Gpdm, ("a sequence has 1 entries; expected 2", |m| m.model.sequences = vec![15, 1]));
    refused(
        LatentKind::Gpdm,
        ("`kind` is gplvm, which does not fit a model of 1 node with dynamics", |m| m.kind = LatentKind::Gplvm),
    );
    refused(LatentKind::Gpdm, ("of 1 node without dynamics", |m| m.model.prior = RootPrior::Normal));
    refused(LatentKind::Gpdm, ("weight 0", |m| m.model.nodes[0].weights[0] = 0.0));
    refused(
        LatentKind::Gpdm,
        ("balance", |m| {
            if let RootPrior::Dynamics { balance, .. } = &mut m.model.prior {
                *balance = f64::INFINITY;
            }
        }),
    );
    refused(
        LatentKind::Gpdm,
        ("column 5 is 0", |m| {
            m.model.nodes[0].outputs = Outputs::Columns(vec![0, 1, 2, 3, 4]);
            m.model.nodes[0].weights.truncate(5);
        }),
    );
    refused(LatentKind::Gplvm, ("inverse width", |m| m.model.nodes[0].back.as_mut().unwrap().inverse_width = 0.0));
    refused(LatentKind::Gplvm, ("coefficient", |m| m.model.nodes[0].back.as_mut().unwrap().coefficients.truncate(1)));
    refused(LatentKind::Hgplvm, ("of 4 nodes with dynamics", |m| m.kind = LatentKind::Gpdm));
    refused(LatentKind::Hgplvm, ("child of a node", |m| m.model.nodes[0].outputs = Outputs::Nodes(vec![0, 3])));
    refused(
        LatentKind::Hgplvm,
        ("row of node 3 is 0; must not be generated by two nodes", |m| {
            m.model.nodes[2].outputs = Outputs::Nodes(vec![3]);
            m.model.nodes[2].weights.clear();
        }),
    );
    refused(LatentKind::Hgplvm, ("column 2 is 0", |m| m.model.nodes[1].outputs = Outputs::Nodes(vec![2])));
    refused(LatentKind::Hgplvm, ("first row of a root", |m| m.model.nodes.swap(0, 1)));
    refused(
        LatentKind::Hgplvm,
        ("nodes; expected at most 256", |m| {
            let leaf = m.model.nodes[3].clone();
            m.model.nodes.resize(300, leaf);
        }),
    );
}

/// Values at the bounds still give finite maps.
#[test]
fn extreme_models_that_are_read_are_used_without_an_error() {
    for (latents, parameters) in [(1e6, 1e12), (1e6, 1e-12), (0.0, 1e12), (1e-6, 1.0)] {
        let mut model = stored(LatentKind::Gpdm);
        for (n, x) in model.model.nodes[0].latents.iter_mut().enumerate() {
            *x = latents * [1.0, -1.0, 0.3, 0.0, 1e-9][n % 5];
        }
        let set = |covariance: &mut sinew_latent::covariance::Covariance| {
            (covariance.variance, covariance.inverse_width, covariance.linear) = (parameters, parameters, parameters);
            covariance.white = 1e-9;
        };
        set(&mut model.model.nodes[0].covariance);
        if let RootPrior::Dynamics { covariance, .. } = &mut model.model.prior {
            set(covariance);
        }
        assert_eq!(check(&model), Ok(()));
        let below = Below::new(&model.model, 0, Isa::baseline()).unwrap();
        let motion = LatentMotion::new(&model.model, 0, StepNoise::Predicted, Isa::baseline()).unwrap();
        let latent = below.encode(model.model.row(3)).unwrap();
        let mut row = vec![0.0; 6];
        below.decode(&latent, &mut row);
        let step = [motion.mean(&latent), motion.variances(&latent)].concat();
        assert!(latent.iter().chain(&row).chain(&step).all(|x| x.is_finite()), "{latent:?} {row:?} {step:?}");
    }
}
