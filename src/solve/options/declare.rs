//! What the table becomes: a struct for each group, with its defaults, and an [`OptionEntry`](super::OptionEntry) for each option.

/// Declares options in groups, as [the table](super::table) writes them.
macro_rules! options {
    // All groups: structs, and the table that the options are read, checked and listed by.
    (
        $(#[doc = $about:literal])+
        $Options:ident $entries:tt
        $(
            $(#[doc = $group_about:literal])+
            $Group:ident as $group:ident $group_entries:tt
        )+
    ) => {
        options! { @struct [Clone, Debug, PartialEq, Serialize, Deserialize] $(#[doc = $about])+ $Options $entries
            $( $(#[doc = $group_about])+ $group: $Group, )+ }
        $( options! { @struct [Clone, Copy, Debug, PartialEq, Serialize, Deserialize] $(#[doc = $group_about])+ $Group $group_entries } )+

        impl $Options {
            /// All options, as they are typed, read, checked and listed.
            pub const GROUPS: &'static [OptionGroup] = &[
                OptionGroup { name: "general", about: concat!($($about),+).trim_ascii(), options: options!(@entries $Options $entries) },
                $( OptionGroup {
                    name: stringify!($group),
                    about: concat!($($group_about),+).trim_ascii(),
                    options: options!(@entries $Group $group_entries),
                }, )+
            ];

            fn of(options: &Self) -> &Self {
                options
            }

            fn of_mut(options: &mut Self) -> &mut Self {
                options
            }
        }

        $( impl $Group {
            fn of(options: &$Options) -> &Self {
                &options.$group
            }

            fn of_mut(options: &mut $Options) -> &mut Self {
                &mut options.$group
            }
        } )+
    };

    // A group as a struct; that of all options has the others as fields.
    (
        @struct [$($derived:ident),+]
        $(#[doc = $about:literal])+
        $Options:ident {
            $( $(#[doc = $help:literal])+ $key:ident: $Type:ty = $default:expr, $range:expr $(, $unit:literal)?; )+
        }
        $( $(#[doc = $group_about:literal])+ $group:ident: $Group:ident, )*
    ) => {
        $(#[doc = $about])+
        #[derive($($derived),+)]
        pub struct $Options {
            $(
                $(#[doc = $help])+
                #[doc = ""]
                $( #[doc = concat!("Unit: ", $unit, ".")] )?
                #[doc = concat!("Range: `", stringify!($range), "`. Default: `", stringify!($default), "`.")]
                pub $key: $Type,
            )+
            $( $(#[doc = $group_about])+ pub $group: $Group, )*
        }

        impl Default for $Options {
            fn default() -> Self {
                Self { $( $key: $default, )+ $( $group: $Group::default(), )* }
            }
        }
    };

    // The options of a group as entries.
    (
        @entries $Group:ident
        { $( $(#[doc = $help:literal])+ $key:ident: $Type:ty = $default:expr, $range:expr $(, $unit:literal)?; )+ }
    ) => {
        &[ $( OptionEntry {
            key: stringify!($key),
            help: concat!($($help),+).trim_ascii(),
            unit: concat!($($unit)?),
            value_type: || type_of::<$Type, _>(&$range),
            range: || Kind::<$Type>::range(&$range),
            show: |options| Kind::<$Type>::show(&$range, &$Group::of(options).$key),
            check: |options| check(stringify!($key), $range, &$Group::of(options).$key),
            reset: |options| $Group::of_mut(options).$key = $default,
            set: |options, text| {
                $Group::of_mut(options).$key = read(stringify!($key), $range, text)?;
                Ok(())
            },
        } ),+ ]
    };
}

pub(super) use options;
